//! Too little room.

use crate::error::Result;
use crate::scene::stability::{
    overlapped, press, pressed_places, pressing_secs, squeeze as squeeze_of,
};
use crate::stability::trial::{Trial, advance, jitter};

const RECOVERY_SECS: f64 = 0.3;
const SETTLING_SECS: f64 = 0.2;
const WATCHED_STEPS: u64 = 100;

/// Two discs that overlap: the share of the overlap that is left after 0.3 s, or the largest kinetic
/// energy on the way, over m g d, whichever is larger.
pub(crate) fn overlap(trial: &Trial) -> Result<f64> {
    let scene = overlapped(trial.level);
    let mut simulation = trial.start(scene)?;
    let world = simulation.world();
    let scale = world.grains.masses[0] * world.gravity.magnitude() * world.mean_diameter;
    let mut energy = 0f64;
    while simulation.time_secs() < RECOVERY_SECS {
        energy = energy.max(simulation.step()?.kinetic_energy / scale);
    }
    let left = simulation.observables().max_overlap / trial.level;
    Ok(left.max(energy))
}

/// Share of the steps that were not solved to their tolerance, or the mean over the last hundred of
/// the speed that does not die out, in √(g d), whichever is larger.
pub(crate) fn squeeze(trial: &Trial) -> Result<f64> {
    let mut simulation = trial.start(squeeze_of(trial.level))?;
    let (mut unsolved, mut speeds) = (0u64, 0.0);
    let settling = simulation.parameters().steps_in(SETTLING_SECS);
    for step in 0..settling + WATCHED_STEPS {
        unsolved += u64::from(!simulation.step()?.converged);
        if step >= settling {
            speeds += jitter(&simulation);
        }
    }
    let share = unsolved as f64 / (settling + WATCHED_STEPS) as f64;
    Ok(share.max(speeds / WATCHED_STEPS as f64))
}

/// When walls have moved in and the grains had time to come to rest: how far the grain that is furthest
/// from its place is from it, in d, or the speed that is left, in √(g d), whichever is larger.
pub(crate) fn moving_walls(trial: &Trial) -> Result<f64> {
    let mut scene = press();
    scene.parameters.time_step_secs = trial.level;
    let mut simulation = trial.start(scene)?;
    advance(&mut simulation, pressing_secs() + SETTLING_SECS)?;
    let world = simulation.world();
    let places = pressed_places();
    let errors =
        world.grains.positions.iter().zip(&places).map(|(now, right)| now.distance(*right));
    let furthest = errors.fold(0.0, f64::max) / world.mean_diameter;
    Ok(furthest.max(jitter(&simulation)))
}
