//! Friction on what slides: what it must not lift, and what it has to follow at once.

use glam::DVec2;

use crate::error::Result;
use crate::scene::stability::{blow as blow_of, dilatancy as dilatancy_of};
use crate::sim::Simulation;
use crate::stability::trial::Trial;

/// Time to slide and to be still, in that of sliding alone.
const WATCHED: f64 = 1.2;
/// Time that the two discs of the blow are watched, s.
const BLOW_SECS: f64 = 0.1;

/// How far a sliding disc leaves its level, in d, or the error of the way to its stop, beyond the half of a
/// step's way that schemes may differ by, over that way; whichever is larger.
pub(crate) fn dilatancy(trial: &Trial) -> Result<f64> {
    let mut scene = dilatancy_of();
    scene.parameters.time_step_secs = trial.level;
    let [start, velocity] = [scene.grains[0].position, scene.grains[0].velocity];
    let slowing = scene.parameters.friction * scene.gravity.magnitude();
    let right = velocity.x.powi(2) / (2.0 * slowing);
    let mut simulation = trial.start(scene)?;
    let diameter = simulation.world().mean_diameter;
    let mut off_level = 0f64;
    while simulation.time_secs() < WATCHED * velocity.x / slowing {
        simulation.step()?;
        let height = simulation.world().grains.positions[0].y - start.y;
        off_level = off_level.max(height.abs() / diameter);
    }
    let way = simulation.world().grains.positions[0].x - start.x;
    let beyond = ((way - right).abs() - 0.5 * velocity.x * trial.level).max(0.0);
    Ok(off_level.max(beyond / right))
}

/// How far off the two discs are along the floor, in d, for friction that is not that of the same time's
/// pressure; or the error of their speed in the end, over what the blow takes of it; whichever is larger.
pub(crate) fn blow(trial: &Trial) -> Result<f64> {
    let mut scene = blow_of();
    scene.parameters.time_step_secs = trial.level;
    let friction = scene.parameters.friction;
    let mut simulation = trial.start(scene)?;
    let mass: f64 = simulation.world().grains.masses.iter().sum();
    let momentum = |simulation: &Simulation| {
        let grains = &simulation.world().grains;
        grains.masses.iter().zip(&grains.velocities).map(|(m, v)| *m * *v).sum::<DVec2>()
    };
    let start = momentum(&simulation);
    let (mut off, mut furthest) = (0f64, 0f64);
    while simulation.time_secs() < BLOW_SECS {
        let before_secs = simulation.time_secs();
        simulation.step()?;
        let now = momentum(&simulation);
        // All that the floor has pushed by now.
        let pushed = now.y - start.y;
        let left = (now.x - (start.x - friction * pushed)) / mass;
        off += left * (simulation.time_secs() - before_secs);
        furthest = furthest.max(off.abs());
    }
    let taken = friction * -start.y / mass;
    let right = start.x / mass - taken;
    let error = (momentum(&simulation).x / mass - right).abs() / taken;
    Ok(error.max(furthest / simulation.world().mean_diameter))
}
