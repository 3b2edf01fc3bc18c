//! One run of a scene, with snapshots at given times.

use std::ops::ControlFlow;

use crate::error::{Error, Result};
use crate::scene::Scene;
use crate::sim::{Observables, RunEnding, Simulation, Snapshot, Tally};

/// What takes down a run while it goes on.
pub trait Recorder {
    /// Called after every step. Breaking ends the run.
    fn step(&mut self, observables: &Observables) -> Result<ControlFlow<()>>;

    /// Called at the start, and after every step, before its pictures, with the whole state and the sums so
    /// far.
    fn state(&mut self, _simulation: &Simulation, _tally: &Tally) -> Result<()> {
        Ok(())
    }

    /// Called at each time that was asked for, with its number and the state at the nearest step.
    fn picture(&mut self, number: usize, snapshot: Snapshot) -> Result<()>;
}

/// A run that goes on, from its start or from later.
#[derive(Debug)]
pub struct OnItsWay {
    /// The simulation so far.
    pub simulation: Simulation,
    /// Sums over its steps so far.
    pub tally: Tally,
    /// The number of the first picture that is not taken yet.
    pub next_picture: usize,
}

/// What a run leaves.
#[derive(Debug)]
pub struct Recorded {
    /// The simulation at its end.
    pub simulation: Simulation,
    /// Sums over its steps.
    pub tally: Tally,
    /// True if the recorder ended it.
    pub interrupted: bool,
    /// Why it ended early, if it failed: its state was no longer finite, or it could not be recorded.
    pub failure: Option<Error>,
}

/// Runs a scene to `until_secs`, with pictures at `times_secs` (rising, s). What it leaves says
/// what ended it early.
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
    let simulation = scene.simulation()?;
    let start = OnItsWay { simulation, tally: Tally::default(), next_picture: 0 };
    Ok(go_on(start, times_secs, until_secs, recorder))
}

/// Lets a run go on to `until_secs`, with those pictures at `times_secs` (rising, s) that are not taken yet.
/// What it leaves says what ended it early.
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
}
