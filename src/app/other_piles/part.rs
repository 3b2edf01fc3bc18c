//! What one thread does: a pile that settles, or a run from its start to its end.

use std::ops::ControlFlow;

use super::band::Series;
use crate::error::Result;
use crate::scene::{Scene, Settling};
use crate::sim::{RunEnding, Simulation};

/// Points of a run at the most, but for its end.
const MOST_POINTS: u64 = 400;
/// A settling ends when the fastest grain is so many orders of magnitude slower than at first.
const ORDERS_OF_SETTLING: f64 = 3.5;

/// How much of a settling is done, 0 … 1: rain falls for a quarter of the limit at most, then the slowing down tells.
pub(super) fn settled_part(settling: &Settling) -> f32 {
    let rained = (4.0 * settling.time_secs / settling.limit_secs).min(1.0);
    let slowed = 1.0 - settling.speed_over_rest.log10() / ORDERS_OF_SETTLING;
    (0.5 * rained * (1.0 + slowed.clamp(0.0, 1.0))) as f32
}

/// The slump of a scene from its start to its end; nothing where `goes_on`, which is asked after each step, says no.
///
/// # Errors
/// Where the scene is not sound, or its state is no longer finite.
pub(super) fn slump(scene: &Scene, mut goes_on: impl FnMut() -> bool) -> Result<Option<Series>> {
    let mut simulation = scene.simulation()?;
    let steps = simulation.step_at(scene.duration_secs);
    let stride = steps.div_ceil(MOST_POINTS).max(1);
    let point = |simulation: &Simulation| [simulation.time_secs(), simulation.observables().slump];
    let mut series = vec![point(&simulation)];
    let ended = simulation.run(steps, |simulation| {
        let step = simulation.observables().step;
        if step.is_multiple_of(stride) || step == steps {
            series.push(point(simulation));
        }
        Ok(if goes_on() { ControlFlow::Continue(()) } else { ControlFlow::Break(()) })
    })?;
    match ended {
        RunEnding::Done => Ok(Some(series)),
        RunEnding::Stopped => Ok(None),
        RunEnding::NotFinite(failure) => Err(failure),
    }
}
