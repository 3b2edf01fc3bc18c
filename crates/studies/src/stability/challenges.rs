//! The list of all challenges.

use super::challenge::{Challenge, Limits};
use super::measures;
use crate::error::{Error, Result};

impl Challenge {
    /// The challenge of that name.
    ///
    /// # Errors
    /// Where there is none.
    pub fn named(name: &str) -> Result<&'static Self> {
        let names = || CHALLENGES.map(|challenge| challenge.name).join(", ");
        CHALLENGES
            .iter()
            .find(|challenge| challenge.name == name)
            .ok_or_else(|| Error::value("scene", name, format!("one of {}", names())))
    }
}

const fn limits(holds: f64, fails: f64) -> Limits {
    Limits { holds, fails }
}

/// All challenges.
pub static CHALLENGES: [Challenge; 28] = [
    Challenge {
        name: "column",
        driver: "discs",
        quick: &[5.0, 20.0, 80.0, 200.0],
        further: &[500.0],
        measure: "error of the floor's force / weight, 100 sweeps a step",
        limits: limits(0.01, 0.2),
        error: measures::column,
    },
    Challenge {
        name: "sag",
        driver: "sweeps a step",
        quick: &[2000.0, 200.0, 20.0, 4.0],
        further: &[],
        measure: "sinking of 20 discs / d, cold start, in 0.1 s",
        limits: limits(0.01, 0.2),
        error: measures::sag,
    },
    Challenge {
        name: "mass-ratio",
        driver: "ratio of masses",
        quick: &[10.0, 100.0, 1e3, 1e4],
        further: &[],
        measure: "sinking / d in 0.1 s, 100 sweeps a step",
        limits: limits(0.01, 0.2),
        error: measures::mass_ratio,
    },
    Challenge {
        name: "size-ratio",
        driver: "ratio of radii",
        quick: &[2.0, 5.0, 20.0, 100.0],
        further: &[],
        measure: "sinking / d in 0.1 s, 100 sweeps a step",
        limits: limits(0.01, 0.2),
        error: measures::size_ratio,
    },
    Challenge {
        name: "chain",
        driver: "time step (s)",
        quick: &[2e-4, 1e-3, 5e-3, 2e-2],
        further: &[],
        measure: "relative error of the breaking Bond number",
        limits: limits(0.02, 0.2),
        error: measures::chain,
    },
    Challenge {
        name: "cantilever",
        driver: "time step (s)",
        quick: &[2e-4, 1e-3, 5e-3, 2e-2],
        further: &[],
        measure: "longest way / d at Bond 100 in 0.25 s",
        limits: limits(0.1, 1.0),
        error: measures::cantilever,
    },
    Challenge {
        name: "bridge",
        driver: "time step (s)",
        quick: &[2e-4, 1e-3, 5e-3, 2e-2],
        further: &[],
        measure: "longest way / d at Bond 100 in 0.25 s",
        limits: limits(0.1, 1.0),
        error: measures::bridge,
    },
    Challenge {
        name: "shock",
        driver: "tolerance (m/s)",
        quick: &[1e-12, 1e-6, 2.2e-3],
        further: &[],
        measure: "gap of the bonded pair / d at Δt = 5e-4 s",
        limits: limits(0.01, 0.1),
        error: measures::shock,
    },
    Challenge {
        name: "overlap",
        driver: "overlap (d)",
        quick: &[0.01, 0.1, 0.5],
        further: &[],
        measure: "overlap left, or energy gained / m g d (1: stays as it is)",
        limits: limits(0.05, 1.1),
        error: measures::overlap,
    },
    Challenge {
        name: "squeeze",
        driver: "strain",
        quick: &[1e-4, 1e-2, 5e-2],
        further: &[],
        measure: "share of unsolved steps, or speed left / √(g d)",
        limits: limits(1e-3, 0.1),
        error: measures::squeeze,
    },
    Challenge {
        name: "moving-walls",
        driver: "time step (s)",
        quick: &[5e-4, 3e-3, 2e-2],
        further: &[],
        measure: "distance from the right place / d, or speed left / √(g d)",
        limits: limits(0.05, 0.5),
        error: measures::moving_walls,
    },
    Challenge {
        name: "friction-limit",
        driver: "time step (s)",
        quick: &[1e-3, 5e-3, 2e-2],
        further: &[],
        measure: "relative error of the least friction of three logs",
        limits: limits(0.05, 0.3),
        error: measures::friction_limit,
    },
    Challenge {
        name: "arch",
        driver: "time step (s)",
        quick: &[1e-3, 5e-3, 2e-2],
        further: &[],
        measure: "relative error of the least friction of an arch of three",
        limits: limits(0.05, 0.3),
        error: measures::arch,
    },
    Challenge {
        name: "repose",
        driver: "time step (s)",
        quick: &[1e-3, 5e-3, 2e-2],
        further: &[],
        measure: "longest way / d in 0.2 s",
        limits: limits(0.01, 0.2),
        error: measures::repose,
    },
    Challenge {
        name: "repose-angle",
        driver: "rows",
        quick: &[2.0, 6.0, 12.0],
        further: &[24.0],
        measure: "relative error of a heap's steepest slope, 100 sweeps a step",
        limits: limits(0.02, 0.2),
        error: measures::repose_angle,
    },
    Challenge {
        name: "rest",
        driver: "steps",
        quick: &[300.0, 10000.0],
        further: &[1e5],
        measure: "longest way / d, or speed / √(g d)",
        limits: limits(0.01, 0.2),
        error: measures::rest,
    },
    Challenge {
        name: "bounce",
        driver: "restitution",
        quick: &[0.0, 0.5, 0.9, 1.0],
        further: &[],
        measure: "error of the first height, or of what is left",
        limits: limits(0.01, 0.1),
        error: measures::bounce,
    },
    Challenge {
        name: "newtons-cradle",
        driver: "balls",
        quick: &[2.0, 3.0, 20.0],
        further: &[],
        measure: "relative error of the last ball's speed",
        limits: limits(0.05, 0.5),
        error: measures::newtons_cradle,
    },
    Challenge {
        name: "thin-wall",
        driver: "travel a step (d)",
        quick: &[0.4, 1.0, 4.0],
        further: &[],
        measure: "share of phases that go through",
        limits: limits(0.0, 0.3),
        error: measures::thin_wall,
    },
    Challenge {
        name: "far",
        driver: "distance from the origin (d)",
        quick: &[1e3, 1e6, 1e9, 1e13],
        further: &[],
        measure: "difference of ways / d after 0.1 s",
        limits: limits(0.01, 0.2),
        error: measures::far,
    },
    Challenge {
        name: "shuffle",
        driver: "tolerance",
        quick: &[1e-9, 1e-6, 1e-3, 1e-1],
        further: &[],
        measure: "difference of velocities / largest",
        limits: limits(1e-4, 0.1),
        error: measures::shuffle,
    },
    Challenge {
        name: "lift-off",
        driver: "ratio of masses",
        quick: &[10.0, 100.0, 1e3, 1e4],
        further: &[],
        measure: "energy after the load is gone / m g d",
        limits: limits(1e-3, 0.1),
        error: measures::lift_off,
    },
    Challenge {
        name: "time-step-switch",
        driver: "factor on 2e-4 s",
        quick: &[2.0, 10.0, 50.0, 200.0],
        further: &[],
        measure: "longest way / d, or speed / √(g d)",
        limits: limits(0.01, 0.2),
        error: measures::time_step_switch,
    },
    Challenge {
        name: "sliders",
        driver: "seconds of sliders at random",
        quick: &[0.5, 2.0, 8.0],
        further: &[60.0],
        measure: "grains lost",
        limits: limits(0.0, 0.0),
        error: measures::sliders,
    },
    Challenge {
        name: "dilatancy",
        driver: "time step (s)",
        quick: &[1e-4, 1e-3, 5e-3],
        further: &[2e-2],
        measure: "rise or sinking of what slides / d, or relative error of its way",
        limits: limits(0.01, 0.1),
        error: measures::dilatancy,
    },
    Challenge {
        name: "blow",
        driver: "time step (s)",
        quick: &[1e-4, 1e-3, 5e-3],
        further: &[],
        measure: "error of the way / d, or of the speed that a blow on what slides takes",
        limits: limits(0.01, 0.1),
        error: measures::blow,
    },
    Challenge {
        name: "hyperstatic",
        driver: "displacement (d)",
        quick: &[1e-4],
        further: &[1e-6],
        measure: "residual, way / d or speed / √(g d) after 20 steps of 40 sweeps, 3,900 contacts",
        limits: limits(0.01, 0.2),
        error: measures::hyperstatic,
    },
    Challenge {
        name: "size",
        driver: "grains",
        quick: &[138.0, 500.0],
        further: &[2000.0, 10000.0],
        measure: "longest way / d, or speed / √(g d), after 20 steps of 40 sweeps",
        limits: limits(1e-3, 0.1),
        error: measures::size,
    },
];
