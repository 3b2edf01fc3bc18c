//! Impacts: bounces, rows of balls, and walls that a step can jump over.

use crate::error::Result;
use crate::scene::stability::{WALL_DISTANCE, balls, bounce as bounce_of, thin_wall as wall_of};
use crate::stability::trial::{Trial, advance};

/// Phases of the step in which the wall is reached.
const PHASES: u32 = 10;
/// Time after a row of balls is hit, s.
const AFTER_SECS: f64 = 0.1;

/// Error of the first bounce's height, over that of the fall; with that, for ρ < 1, the speed left
/// when all bounces are over, over that of the first impact; for ρ = 1, the relative error of the
/// energy after ten falls.
pub(crate) fn bounce(trial: &Trial) -> Result<f64> {
    let restitution = trial.level;
    let scene = bounce_of(restitution);
    let radius = scene.grains[0].radius;
    let drop = scene.grains[0].position.y - radius;
    let gravity = scene.gravity.magnitude();
    let fall_secs = (2.0 * drop / gravity).sqrt();
    let end_secs = if restitution < 1.0 {
        fall_secs * ((1.0 + restitution) / (1.0 - restitution) + 1.0)
    } else {
        10.0 * fall_secs
    };
    let mut simulation = trial.start(scene)?;
    let (mut touched, mut bounces, mut highest) = (false, 0, 0f64);
    while simulation.time_secs() < end_secs {
        let touches = simulation.step()?.contacts > 0;
        bounces += u32::from(touches && !touched);
        touched = touches;
        if bounces == 1 {
            highest = highest.max(simulation.world().grains.positions[0].y - radius);
        }
    }
    let first = (highest / drop - restitution * restitution).abs();
    let grains = &simulation.world().grains;
    let speed = grains.velocities[0].length();
    let last = if restitution < 1.0 {
        speed / (gravity * fall_secs)
    } else {
        let height = grains.positions[0].y - radius;
        ((0.5 * speed * speed + gravity * height) / (gravity * drop) - 1.0).abs()
    };
    Ok(first.max(last))
}

/// Relative error of the last ball's speed.
pub(crate) fn newtons_cradle(trial: &Trial) -> Result<f64> {
    let scene = balls(trial.count());
    let right = scene.grains[0].velocity.x;
    let mut simulation = trial.start(scene)?;
    advance(&mut simulation, AFTER_SECS)?;
    let velocities = &simulation.world().grains.velocities;
    Ok((velocities[velocities.len() - 1].x / right - 1.0).abs())
}

/// Share of phases in which the disc goes through the wall.
pub(crate) fn thin_wall(trial: &Trial) -> Result<f64> {
    let mut through = 0;
    for phase in 0..PHASES {
        let scene = wall_of(trial.level, (f64::from(phase) + 0.5) / f64::from(PHASES));
        let wall = WALL_DISTANCE * scene.mean_diameter;
        let mut simulation = trial.start(scene)?;
        simulation.take_steps(((WALL_DISTANCE + 5.0) / trial.level) as u64)?;
        through += u32::from(simulation.world().grains.positions[0].x > wall);
    }
    Ok(f64::from(through) / f64::from(PHASES))
}
