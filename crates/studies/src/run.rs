//! Runs a scene once, with snapshots at given times.

use std::ops::ControlFlow;

use crate::error::{Error, Result};
use crate::scene::Scene;
use crate::sim::{Observables, RunEnding, Simulation, Snapshot, Tally};

/// An observer of a run: receives the results of every step, and the snapshots of the grains at requested times.
pub trait Recorder {
    /// Receives the observables (measured numbers, such as the slump) after every step. The run ends if the function
    /// returns `Break`.
    fn step(&mut self, observables: &Observables) -> Result<ControlFlow<()>>;

    /// Receives the complete state of the simulation, and the statistics of all steps so far, at the start and after
    /// every step. If a snapshot is due after the step, this function is called before `picture`.
    fn state(&mut self, _simulation: &Simulation, _tally: &Tally) -> Result<()> {
        Ok(())
    }

    /// Receives the snapshot of the step that is nearest to a requested time. `number` is the position of that time in
    /// the list of requested times, counted from 0.
    fn picture(&mut self, number: usize, snapshot: Snapshot) -> Result<()>;
}

/// A run that has begun and can be continued.
#[derive(Debug)]
pub struct OnItsWay {
    /// The simulation in its present state.
    pub simulation: Simulation,
    /// Statistics of the steps that are already computed, such as the number of sweeps and the mean overlap.
    pub tally: Tally,
    /// Position of the next snapshot's time in the list of requested times, counted from 0.
    pub next_picture: usize,
}

/// The result of a run.
#[derive(Debug)]
pub struct Recorded {
    /// The simulation in its final state.
    pub simulation: Simulation,
    /// Statistics of all steps of the run, such as the number of sweeps and the mean overlap.
    pub tally: Tally,
    /// True if the [`Recorder`], which observes the run, ended the run early.
    pub interrupted: bool,
    /// The error that ended the run early, if any: positions or velocities became NaN or infinite, or the [`Recorder`],
    /// which observes the run, returned an error.
    pub failure: Option<Error>,
}

/// Runs a scene until the simulated time `until_secs` (s), with snapshots at `times_secs` (ascending, s). If an error
/// ends the run early, the result contains that error.
///
/// # Errors
/// If the scene is invalid, or if a time is negative or later than the duration of the scene.
pub fn record(
    scene: &Scene,
    times_secs: &[f64],
    until_secs: f64,
    recorder: &mut impl Recorder,
) -> Result<Recorded> {
    // The limit has a margin of half a step, because a duration need not be a multiple of the time step Δt.
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

/// Continues a run until the simulated time `until_secs` (s), with the remaining snapshots of the list `times_secs`
/// (ascending, s). If an error ends the run early, the result contains that error.
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
                // The step that led to a state with NaN or infinity also gets a row, so that the table and the sums
                // have the same steps.
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
