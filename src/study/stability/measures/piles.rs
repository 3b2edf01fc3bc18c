//! Piles that have to stand still, and one that has to give way.

use crate::error::Result;
use crate::scene::stability::{heap, logs};
use crate::study::stability::trial::{Trial, advance, jitter, longest_way, steps_of, threshold};

/// Rows of the heap that is left standing.
const ROWS: usize = 6;
const STANDING_SECS: f64 = 0.2;
/// Rows of the heap that is left for very many steps.
const SMALL_ROWS: usize = 4;
/// The log pile of equal discs slides below μ = tan 15° = 2 − √3.
const RIGHT_FRICTION: f64 = 0.267_949_192_431_122_7;
/// It has slid when its top is lower by this, in d.
const SLID: f64 = 0.02;
const SLIDING_SECS: f64 = 0.2;
/// From a quarter of the right friction to four times that, down to 1 %.
const HALVINGS: u32 = 8;

/// How far the grain of a heap that moves most goes, in d.
pub fn repose(trial: &Trial) -> Result<f64> {
    let mut scene = heap(ROWS);
    scene.parameters.time_step_secs = trial.level;
    let mut simulation = trial.start(scene.clone())?;
    advance(&mut simulation, STANDING_SECS)?;
    Ok(longest_way(&simulation, &scene))
}

/// Relative error of the friction at which three piled logs slide apart.
pub fn friction_limit(trial: &Trial) -> Result<f64> {
    let found = threshold([0.25 * RIGHT_FRICTION, 4.0 * RIGHT_FRICTION], HALVINGS, |friction| {
        let mut scene = logs(1.0);
        scene.parameters.friction = friction;
        scene.parameters.time_step_secs = trial.level;
        let mut simulation = trial.start(scene.clone())?;
        advance(&mut simulation, SLIDING_SECS)?;
        Ok(longest_way(&simulation, &scene) < SLID)
    })?;
    Ok((found / RIGHT_FRICTION - 1.0).abs())
}

/// After very many steps at rest: the longest way of any grain, in d, or the speed that is left, in
/// √(g d), whichever is larger.
pub fn rest(trial: &Trial) -> Result<f64> {
    let scene = heap(SMALL_ROWS);
    let mut simulation = trial.start(scene.clone())?;
    steps_of(&mut simulation, trial.count() as u64)?;
    Ok(longest_way(&simulation, &scene).max(jitter(&simulation)))
}
