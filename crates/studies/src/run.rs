//! One run of a scene, with snapshots at given times.

use std::ops::ControlFlow;

use crate::error::{Error, Result};
use crate::scene::Scene;
use crate::sim::{Observables, RunEnding, Simulation, Snapshot, Tally};

/// Observer of a run.
pub trait Recorder {
    /// Called after every step. Breaking ends the run.
    fn step(&mut self, observables: &Observables) -> Result<ControlFlow<()>>;

    /// Called at the start, and after every step before its pictures, with the complete state and the sums so far.
    fn state(&mut self, _simulation: &Simulation, _tally: &Tally) -> Result<()> {
        Ok(())
    }

    /// Called for each requested time, with its number and the state at the nearest step.
    fn picture(&mut self, number: usize, snapshot: Snapshot) -> Result<()>;
}

/// A run in progress.
#[derive(Debug)]
pub struct OnItsWay {
    /// The simulation so far.
    pub simulation: Simulation,
    /// Sums over its steps so far.
    pub tally: Tally,
    /// The number of the next picture.
    pub next_picture: usize,
}

/// The result of a run.
#[derive(Debug)]
pub struct Recorded {
    /// The simulation at its end.
    pub simulation: Simulation,
    /// Sums over its steps.
    pub tally: Tally,
    /// True if the recorder ended it.
    pub interrupted: bool,
    /// The error that ended it early, if any: its state was no longer finite, or it could not be recorded.
    pub failure: Option<Error>,
}

/// Runs a scene to `until_secs`, with pictures at `times_secs` (ascending, s). The result contains the error that ended
/// it early, if any.
///
/// # Errors
/// If the scene is invalid, or a time is outside 0 … duration.
pub fn record(
    scene: &Scene,
    times_secs: &[f64],
    until_secs: f64,
    recorder: &mut impl Recorder,
) -> Result<Recorded> {
    // With a margin of half a step, so that a duration that is not a multiple of Δt is allowed.
    let latest = scene.duration_secs + 0.5 * scene.parameters.time_step_secs;
    let outside = |time: &&f64| !(0.0..=latest).contains(*time);
    if let Some(time) = times_secs.iter().chain([&until_secs]).find(outside) {
        let allowed = format!("between 0 and the duration of {} s", scene.duration_secs);
        return Err(Error::value("times", time, allowed));
    }
    let simulation = scene.simulation()?;
    let start = OnItsWay { simulation, tally: Tally::default(), next_picture: 0 };
    Ok(go_on(start, times_secs, until_secs, recorder))
}

/// Continues a run to `until_secs`, with the remaining pictures at `times_secs` (ascending, s). The result contains the
/// error that ended it early, if any.
pub fn go_on(
    mut run: OnItsWay,
    times_secs: &[f64],
    until_secs: f64,
    recorder: &mut impl Recorder,
) -> Recorded {
    let ended = run.take_down(times_secs, until_secs, recorder);
    let OnItsWay { simulation, tally, .. } = run;
    let interrupted = matches!(ended, Ok(RunEnding::Stopped));
    let failure = match ended {
        Ok(RunEnding::NotFinite(failure)) | Err(failure) => Some(failure),
        Ok(RunEnding::Done | RunEnding::Stopped) => None,
    };
    Recorded { simulation, tally, interrupted, failure }
}

impl OnItsWay {
    fn take_down(
        &mut self,
        times_secs: &[f64],
        until_secs: f64,
        recorder: &mut impl Recorder,
    ) -> Result<RunEnding> {
        let Self { simulation, tally, next_picture } = self;
        recorder.state(simulation, tally)?;
        let pictures = times_secs.iter().enumerate().map(|(number, &time)| (Some(number), time));
        for (number, time_secs) in pictures.skip(*next_picture).chain([(None, until_secs)]) {
            let last = simulation.step_at(time_secs);
            let steps = last.saturating_sub(simulation.observables().step);
            let ended = simulation.run(steps, |simulation| {
                tally.add(simulation.observables());
                let goes_on = recorder.step(simulation.observables())?;
                recorder.state(simulation, tally)?;
                Ok(goes_on)
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
                // The step that became non-finite also has a row, so that table and tally agree.
                tally.add(simulation.observables());
                let _ = recorder.step(simulation.observables())?;
            }
            if !matches!(ended, RunEnding::Done) {
                return Ok(ended);
            }
        }
        Ok(RunEnding::Done)
    }
}
