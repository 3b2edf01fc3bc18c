//! One run of a scene, with snapshots at given times.

use std::ops::ControlFlow;

use crate::error::{Error, Result};
use crate::scene::Scene;
use crate::sim::{Observables, RunEnding, Simulation, Snapshot, Tally};

/// What takes down a run while it goes on.
pub trait Recorder {
    /// Called after every step. Breaking ends the run.
    ///
    /// # Errors
    /// Where it cannot be taken down; the run ends.
    fn step(&mut self, observables: &Observables) -> Result<ControlFlow<()>>;

    /// Called at each time that was asked for, with its number and the state at the nearest step.
    ///
    /// # Errors
    /// Where it cannot be taken down; the run ends.
    fn picture(&mut self, number: usize, snapshot: Snapshot) -> Result<()>;
}

/// What a run leaves.
#[derive(Debug)]
pub struct Recorded {
    /// The simulation at its end.
    pub simulation: Simulation,
    /// Sums over its steps.
    pub tally: Tally,
    /// Whether the recorder ended it.
    pub interrupted: bool,
    /// Why it ended early, if it failed: its state was no longer finite, or it could not be recorded.
    pub failure: Option<Error>,
}

/// Runs a scene to `until_secs`, with pictures at `times_secs` (rising, s). What ends it early is told
/// of in what it leaves.
///
/// # Errors
/// Where the scene is not sound, or a time lies outside 0 … duration.
pub fn record(
    scene: &Scene,
    times_secs: &[f64],
    until_secs: f64,
    recorder: &mut impl Recorder,
) -> Result<Recorded> {
    // Half a step of room, so that a duration that is no multiple of Δt can be asked for.
    let latest = scene.duration_secs + 0.5 * scene.parameters.time_step_secs;
    let outside = |time: &&f64| !(0.0..=latest).contains(*time);
    if let Some(time) = times_secs.iter().chain([&until_secs]).find(outside) {
        let allowed = format!("between 0 and the duration of {} s", scene.duration_secs);
        return Err(Error::value("times", time, allowed));
    }
    let mut simulation = scene.simulation()?;
    let mut tally = Tally::default();
    let ended = run(&mut simulation, times_secs, until_secs, &mut tally, recorder);
    let interrupted = matches!(ended, Ok(RunEnding::Stopped));
    let failure = match ended {
        Ok(RunEnding::NotFinite(failure)) | Err(failure) => Some(failure),
        Ok(RunEnding::Done | RunEnding::Stopped) => None,
    };
    Ok(Recorded { simulation, tally, interrupted, failure })
}

fn run(
    simulation: &mut Simulation,
    times_secs: &[f64],
    until_secs: f64,
    tally: &mut Tally,
    recorder: &mut impl Recorder,
) -> Result<RunEnding> {
    let parameters = *simulation.parameters();
    let pictures = times_secs.iter().enumerate().map(|(number, &time)| (Some(number), time));
    for (number, time_secs) in pictures.chain([(None, until_secs)]) {
        let last = parameters.steps_in(time_secs);
        let steps = last.saturating_sub(simulation.observables().step);
        let ended = simulation.run(steps, |simulation| {
            tally.add(simulation.observables());
            recorder.step(simulation.observables())
        })?;
        let is_there = match ended {
            RunEnding::Done => true,
            RunEnding::Stopped => simulation.observables().step == last,
            RunEnding::NotFinite(_) => false,
        };
        if let Some(number) = number.filter(|_| is_there) {
            recorder.picture(number, simulation.snapshot())?;
        }
        if let RunEnding::NotFinite(_) = ended {
            // The row of the step that blew up is one of them, so that table and tally tell the same.
            tally.add(simulation.observables());
            let _ = recorder.step(simulation.observables())?;
        }
        if !matches!(ended, RunEnding::Done) {
            return Ok(ended);
        }
    }
    Ok(RunEnding::Done)
}
