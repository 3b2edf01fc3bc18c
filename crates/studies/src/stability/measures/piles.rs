//! Piles that have to stand still, and one that has to give way.

use crate::error::Result;
use crate::scene::Scene;
use crate::scene::stability::{
    FRICTION_OF_ARCH, STEEPEST_DEGREES, arch as arch_of, heap, heap_on_slope, logs,
};
use crate::stability::trial::{Trial, advance, longest_way, threshold, unrest};

/// Rows of the heap that is left standing.
const ROWS: usize = 6;
const STANDING_SECS: f64 = 0.2;
/// Rows of the heap that is left for very many steps.
const SMALL_ROWS: usize = 4;
/// Sweeps of a step of a heap on a slope: few, as in a window that has to keep up.
const FEW_SWEEPS: u32 = 100;
/// The log pile of equal discs slides below μ = tan 15° = 2 − √3.
const FRICTION_OF_LOGS: f64 = 0.267_949_192_431_122_7;
/// What slides has gone this far, in d, when the watch ends.
const SLID: f64 = 0.02;
const SLIDING_SECS: f64 = 0.2;
/// Frictions and angles are searched from a part of the right one to as many times that, with
/// halvings down to 1 % and to 0.5 %.
const FRICTION_RANGE: f64 = 4.0;
const ANGLE_RANGE: f64 = 2.0;
const HALVINGS: u32 = 8;

/// How far the grain of a heap that moves most goes, in d.
pub(crate) fn repose(trial: &Trial) -> Result<f64> {
    let mut scene = heap(ROWS);
    scene.parameters.time_step_secs = trial.level;
    let mut simulation = trial.start(scene.clone())?;
    advance(&mut simulation, STANDING_SECS)?;
    Ok(longest_way(&simulation, &scene))
}

/// Relative error of the friction at which three piled logs slide apart.
pub(crate) fn friction_limit(trial: &Trial) -> Result<f64> {
    least_friction(trial, &logs(1.0), FRICTION_OF_LOGS)
}

/// Relative error of the friction at which the keystone of an arch slips through.
pub(crate) fn arch(trial: &Trial) -> Result<f64> {
    least_friction(trial, &arch_of(), FRICTION_OF_ARCH)
}

fn least_friction(trial: &Trial, scene: &Scene, right: f64) -> Result<f64> {
    let range = [right / FRICTION_RANGE, right * FRICTION_RANGE];
    let found = threshold(range, HALVINGS, |friction| {
        let mut scene = scene.clone();
        scene.parameters.friction = friction;
        scene.parameters.time_step_secs = trial.level;
        Ok(!slides(trial, scene)?)
    })?;
    Ok((found / right - 1.0).abs())
}

/// Relative error of the steepest slope on which a heap stands.
pub(crate) fn repose_angle(trial: &Trial) -> Result<f64> {
    let range = [STEEPEST_DEGREES / ANGLE_RANGE, STEEPEST_DEGREES * ANGLE_RANGE];
    let found = threshold(range, HALVINGS, |degrees| {
        let mut scene = heap_on_slope(trial.count(), degrees);
        scene.solver.max_sweeps = FEW_SWEEPS;
        slides(trial, scene)
    })?;
    Ok((found / STEEPEST_DEGREES - 1.0).abs())
}

/// Whether any grain of a scene goes far.
fn slides(trial: &Trial, scene: Scene) -> Result<bool> {
    let mut simulation = trial.start(scene.clone())?;
    advance(&mut simulation, SLIDING_SECS)?;
    Ok(longest_way(&simulation, &scene) >= SLID)
}

/// After very many steps at rest: the longest way of any grain, in d, or the speed that is left, in
/// √(g d), whichever is larger.
pub(crate) fn rest(trial: &Trial) -> Result<f64> {
    let scene = heap(SMALL_ROWS);
    let mut simulation = trial.start(scene.clone())?;
    simulation.take_steps(trial.count() as u64)?;
    Ok(unrest(&simulation, &scene))
}
