//! One run of a scene, with snapshots at given times.

use std::ops::ControlFlow;

use crate::error::{Error, Result};
use crate::scene::Scene;
use crate::sim::{Observables, RunEnding, Simulation, Snapshot, Tally};

/// What a run leaves.
#[derive(Debug)]
pub(crate) struct Recorded {
    /// The simulation at its end.
    pub simulation: Simulation,
    /// Sums over its steps.
    pub tally: Tally,
    /// Why it ended early, if it did: its state was no longer finite.
    pub failure: Option<Error>,
}

/// Runs a scene through `times_secs` (rising, s), calling `picture` at each with its number and the
/// state at the nearest step, and `after_step` after every step. A state that is no longer finite ends
/// the run, and is told of in what it leaves.
///
/// # Errors
/// Where the scene is not sound, a time lies outside 0 … duration, or a call says so.
pub(crate) fn record(
    scene: &Scene,
    times_secs: &[f64],
    mut picture: impl FnMut(usize, Snapshot) -> Result<()>,
    mut after_step: impl FnMut(&Observables) -> Result<()>,
) -> Result<Recorded> {
    let mut simulation = scene.simulation()?;
    let time_step_secs = scene.parameters.time_step_secs;
    let mut tally = Tally::default();
    for (number, &time_secs) in times_secs.iter().enumerate() {
        // Half a step of room, so that a duration that is no multiple of Δt can be asked for.
        if !(0.0..=scene.duration_secs + 0.5 * time_step_secs).contains(&time_secs) {
            let allowed = format!("between 0 and the duration of {} s", scene.duration_secs);
            return Err(Error::value("times", time_secs, allowed));
        }
        let step = scene.parameters.steps_in(time_secs);
        let steps = step.saturating_sub(simulation.observables().step);
        let ended = simulation.run(steps, |simulation| {
            tally.add(simulation.observables());
            after_step(simulation.observables())?;
            Ok(ControlFlow::Continue(()))
        })?;
        if let RunEnding::NotFinite(failure) = ended {
            return Ok(Recorded { simulation, tally, failure: Some(failure) });
        }
        picture(number, simulation.snapshot())?;
    }
    Ok(Recorded { simulation, tally, failure: None })
}
