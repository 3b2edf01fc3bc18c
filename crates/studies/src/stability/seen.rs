//! Measures the errors of stability tests at a single simulated time of a run, for the program's graphical window. Each
//! error is 0 for the right answer, and is compared with the limits of its test. Errors are only defined after the
//! first step, and after the time at which the scene should have reached the right answer.

use glam::DVec2;

use super::{jitter_of, longest_way_to};
use crate::scene::stability as scenes;
use crate::sim::{Simulation, Snapshot};

/// A measure of the error of a stability test that can be evaluated at a single simulated time.
#[derive(Clone, Copy, Debug)]
pub struct SeenError {
    /// Name and unit of the error, as text.
    pub name: &'static str,
    /// Function that returns the error from the simulation at the start of the run and the present snapshot; `None` if
    /// it is too early to judge the run.
    pub(super) of: fn(&Simulation, &Snapshot) -> Option<f64>,
}

const fn error(name: &'static str, of: fn(&Simulation, &Snapshot) -> Option<f64>) -> SeenError {
    SeenError { name, of }
}

/// Error of scenes that must stay at rest: the largest displacement of a grain, in diameters.
pub(super) const MOVED: SeenError =
    error("largest displacement in diameters", |start, now| Some(moved(start, now)));
/// Error of scenes that must come to rest: the root mean square speed of the grains after 0.2 s, in √(g d), with
/// gravity g and mean diameter d.
pub(super) const RESTLESS: SeenError =
    error("remaining speed in √(g d)", |start, now| after(0.2, now, || restless(start, now)));
pub(super) const KINETIC: SeenError = error("kinetic energy in m g d", |start, now| {
    Some(now.observables.kinetic_energy / super::energy_scale(start))
});
pub(super) const OVERLAP: SeenError = error("part of the overlap that is left", |start, now| {
    after(0.3, now, || now.observables.max_overlap / start.observables().max_overlap)
});
pub(super) const PRESSED: SeenError =
    error("largest distance from the right place in diameters", |start, now| {
        after(scenes::pressing_secs() + 0.2, now, || {
            let pairs = places(now).zip(scenes::pressed_places());
            pairs.map(|(now, right)| now.distance(right)).fold(0.0, f64::max)
                / start.world().mean_diameter
        })
    });
pub(super) const LAST_BALL: SeenError =
    error("error of the speed of the last ball, relative", |start, now| {
        let right = start.world().grains.velocities[0].x;
        // The first ball flies one diameter before it hits the row, and the impact takes a few steps to pass the row.
        let struck_secs = 2.0 * start.world().mean_diameter / right;
        after(struck_secs, now, || {
            (now.grains[now.grains.len() - 1].velocity.x / right - 1.0).abs()
        })
    });
pub(super) const BOUNCED: SeenError = error("error of the energy, relative", |start, now| {
    let (world, parameters) = (start.world(), start.parameters());
    let (radius, gravity) = (world.grains.radii[0], world.gravity.magnitude());
    let drop = world.grains.positions[0].y - radius;
    let fall_secs = (2.0 * drop / gravity).sqrt();
    let slack_secs = 2.0 * now.observables.time_step_secs;
    // With the restitution ρ and the duration T of the fall, bounce n happens at the time T (1 + 2ρ + … + 2ρⁿ⁻¹) and
    // leaves the fraction ρ²ⁿ of the energy.
    let (mut left, mut next_secs, mut part) = (1.0, fall_secs, 1.0);
    while next_secs + slack_secs < now.observables.time_secs && part > 1e-3 {
        part *= parameters.restitution;
        left = part * part;
        next_secs += 2.0 * part * fall_secs;
    }
    let grain = &now.grains[0];
    let height = grain.position.y - radius;
    let energy = 0.5 * grain.velocity.length_squared() + gravity * height;
    let is_apart = (now.observables.time_secs - next_secs).abs() > slack_secs;
    is_apart.then(|| (energy / (gravity * drop) - left).abs())
});
pub(super) const THROUGH: SeenError = error("discs beyond the wall", |start, now| {
    let wall = scenes::WALL_DISTANCE * start.world().mean_diameter;
    Some(places(now).filter(|place| place.x > wall).count() as f64)
});
pub(super) const OFF_LEVEL: SeenError =
    error("distance from the level of the start in diameters", |start, now| {
        let world = start.world();
        Some((now.grains[0].position.y - world.grains.positions[0].y).abs() / world.mean_diameter)
    });
pub(super) const BLOWN: SeenError = error("error of the loss of speed, relative", |start, now| {
    let grains = &start.world().grains;
    let sum = |velocities: &mut dyn Iterator<Item = DVec2>| -> DVec2 {
        grains.masses.iter().zip(velocities).map(|(mass, velocity)| *mass * velocity).sum()
    };
    let before = sum(&mut grains.velocities.iter().copied());
    let after_blow = sum(&mut now.grains.iter().map(|grain| grain.velocity));
    let taken = start.parameters().friction * -before.y;
    after(0.05, now, || ((before.x - after_blow.x) / taken - 1.0).abs())
});

fn places(now: &Snapshot) -> impl Iterator<Item = DVec2> {
    now.grains.iter().map(|grain| grain.position)
}

fn moved(start: &Simulation, now: &Snapshot) -> f64 {
    let world = start.world();
    longest_way_to(world.grains.positions.iter().copied().zip(places(now)), world.mean_diameter)
}

fn restless(start: &Simulation, now: &Snapshot) -> f64 {
    jitter_of(start.world(), now.observables.kinetic_energy)
}

/// Returns the result of `error` if the snapshot `now` is at or after the simulated time `secs` (s), otherwise `None`.
fn after(secs: f64, now: &Snapshot, error: impl FnOnce() -> f64) -> Option<f64> {
    (now.observables.time_secs >= secs).then(error)
}
