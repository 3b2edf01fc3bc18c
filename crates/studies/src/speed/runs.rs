//! Whole runs of piles against the clock.

use std::ops::ControlFlow;
use std::time::Instant;

use serde::{Deserialize, Serialize};

use crate::error::Result;
use crate::number;
use crate::scene::Scene;
use crate::sim::{RunEnding, Simulation, Tally};

/// Steps between two looks at the clock.
const STEPS_PER_LOOK: u64 = 16;

/// What disturbs a run that takes longer, s, averages out within it.
const LONG_ENOUGH_SECS: f64 = 2.0;

/// How a timed run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Ending {
    /// At its full duration.
    Done,
    /// It took longer than it was given.
    TooSlow,
    /// Its state was no longer finite.
    NotFinite,
}

/// One timed run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct TimedRun {
    /// Tells it apart from the others.
    pub key: String,
    pub ending: Ending,
    /// Least of its repeats, s.
    pub wall_secs: f64,
    pub simulated_secs: f64,
    pub steps: u64,
    pub unconverged_steps: u64,
    /// Δy_G at the end.
    #[serde(with = "number")]
    pub slump: f64,
    /// Mean over the steps, in diameters.
    #[serde(with = "number")]
    pub mean_overlap: f64,
}

/// Runs a scene to its end, `repeats` times for the least time, unless it takes more than
/// `limit_secs` of the wall's time.
///
/// # Errors
/// Where the scene is not sound.
pub(super) fn timed_run(
    key: String,
    scene: &Scene,
    repeats: u32,
    limit_secs: f64,
) -> Result<TimedRun> {
    let steps = scene.parameters.steps_in(scene.duration_secs);
    timed_steps(key, &scene.simulation()?, steps, repeats, limit_secs)
}

/// Takes so many steps from a start, `repeats` times for the least time, unless that takes more than
/// `limit_secs` of the wall's time. A run that takes longer than [`LONG_ENOUGH_SECS`] is not repeated.
///
/// # Errors
/// Where the settings of the start do not fit it. A state that is no longer finite is an ending.
pub(super) fn timed_steps(
    key: String,
    start: &Simulation,
    steps: u64,
    repeats: u32,
    limit_secs: f64,
) -> Result<TimedRun> {
    let mut run = once(key, start, steps, limit_secs)?;
    for _ in 1..repeats {
        if run.ending != Ending::Done || run.wall_secs > LONG_ENOUGH_SECS {
            break;
        }
        let again = once(String::new(), start, steps, limit_secs)?;
        run.wall_secs = run.wall_secs.min(again.wall_secs);
    }
    Ok(run)
}

fn once(key: String, start: &Simulation, steps: u64, limit_secs: f64) -> Result<TimedRun> {
    let mut simulation = start.clone();
    let mut tally = Tally::default();
    let started = Instant::now();
    let ended = simulation.run(steps, |simulation| {
        tally.add(simulation.observables());
        let looks = tally.steps % STEPS_PER_LOOK == 0 && tally.steps < steps;
        Ok(if looks && started.elapsed().as_secs_f64() > limit_secs {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        })
    })?;
    let ending = match ended {
        RunEnding::Done => Ending::Done,
        RunEnding::Stopped => Ending::TooSlow,
        RunEnding::NotFinite(_) => {
            tally.add(simulation.observables());
            Ending::NotFinite
        }
    };
    let wall_secs = started.elapsed().as_secs_f64();
    Ok(TimedRun {
        key,
        ending,
        wall_secs,
        simulated_secs: simulation.time_secs() - start.time_secs(),
        steps: tally.steps,
        unconverged_steps: tally.unconverged_steps,
        slump: simulation.observables().slump,
        mean_overlap: tally.mean_overlap,
    })
}
