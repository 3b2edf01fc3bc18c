//! What settling has in common, whichever way the grains were put in place: the box, how far it has
//! come, and what is said of a pile that has come to rest.

use glam::DVec2;

use crate::error::{Error, Result};
use crate::scene::Scene;
use crate::scene::pile::{DIAMETER, GRAVITY, pile_of};
use crate::sim::{Observables, Simulation};
use crate::solver::SolverSettings;
use crate::world::{Boundary, Grain, Parameters};

/// A pile is at rest when it has been so slow for this long, s.
pub(super) const REST_SECS: f64 = 0.02;

/// How far a settling has come.
#[derive(Clone, Copy, Debug)]
pub struct Settling<'a> {
    /// The pile as it is now.
    pub simulation: &'a Simulation,
    /// Whether grains may still be falling through the medium of the rain.
    pub rains: bool,
    /// Simulated time, s.
    pub time_secs: f64,
    /// Simulated time after which it is given up, s.
    pub limit_secs: f64,
    /// Fastest grain, in units of the speed that counts as rest.
    pub speed_over_rest: f64,
}

/// A pile at rest: its velocities are zero, and this is what they were.
#[derive(Clone, Debug)]
pub struct Settled {
    /// The grains.
    pub grains: Vec<Grain>,
    /// Mean kinetic energy of a grain when it was said to be at rest, in m g d.
    pub kinetic_energy: f64,
    /// Mean overlap of touching pairs, in d.
    pub mean_overlap: f64,
    /// Largest overlap of all contacts, in d.
    pub max_overlap: f64,
}

impl Settled {
    /// The grains of a simulation that has come to rest.
    pub(super) fn of(mut simulation: Simulation) -> Self {
        let kinetic_energy = kinetic_energy(&simulation);
        let &Observables { mean_overlap, max_overlap, .. } = simulation.observables();
        simulation.bring_to_rest();
        let grains = &simulation.world().grains;
        let grains = (0..grains.len())
            .map(|index| Grain { angular_velocity: 0.0, ..grains.grain(index) })
            .collect();
        Self { grains, kinetic_energy, mean_overlap, max_overlap }
    }
}

/// That `progress` ended it.
pub(super) fn interrupted() -> Error {
    Error::value("generation", "interrupted", "left to end")
}

/// That it takes too long.
pub(super) fn not_at_rest(speed_over_rest: f64, limit_secs: f64) -> Error {
    let allowed = format!("below 1 within {limit_secs:.1} s of simulated time");
    Error::value("speed over rest", speed_over_rest, allowed)
}

/// The walls of a box for the pile's scene.
pub fn walls(box_width_in_diameters: f64) -> Vec<Boundary> {
    let wall = |side: f64| Boundary::HalfSpace {
        point: DVec2::new(side * 0.5 * box_width_in_diameters * DIAMETER, 0.0),
        normal: DVec2::new(-side, 0.0),
    };
    vec![wall(-1.0), wall(1.0)]
}

/// The pile's scene without cohesion and with walls.
pub(super) fn in_a_box(
    grains: Vec<Grain>,
    box_width_in_diameters: f64,
    time_step_secs: f64,
    solver: SolverSettings,
) -> Result<Scene> {
    let pile = pile_of(grains, box_width_in_diameters)?;
    Ok(Scene {
        boundaries: walls(box_width_in_diameters),
        parameters: Parameters { bond: 0.0, time_step_secs, ..pile.parameters },
        solver,
        ..pile
    })
}

/// Speed of the fastest grain, m/s.
pub(super) fn fastest(simulation: &Simulation) -> f64 {
    speeds(simulation).fold(0.0, f64::max)
}

/// Speed of each grain, of its centre or its rim, m/s.
pub(super) fn speeds(simulation: &Simulation) -> impl Iterator<Item = f64> {
    let grains = &simulation.world().grains;
    let turning = grains.angular_velocities.iter().zip(&grains.radii).map(|(w, r)| (w * r).abs());
    grains.velocities.iter().map(|velocity| velocity.length()).zip(turning).map(|(v, w)| v.max(w))
}

/// Mean kinetic energy of a grain, in m g d.
pub(super) fn kinetic_energy(simulation: &Simulation) -> f64 {
    let weight: f64 = simulation.world().grains.masses.iter().map(|mass| mass * GRAVITY).sum();
    simulation.observables().kinetic_energy / (weight * DIAMETER)
}
