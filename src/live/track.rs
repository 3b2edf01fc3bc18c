//! One world of a live run: its simulation, its recording and its curve.

use std::sync::Arc;
use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::film::Film;
use super::{Curve, Recording, Replay, Taken};
use crate::sim::{Settings, Simulation, Tally};

/// Weight of the newest step in the mean time a step takes.
const NEWEST: f64 = 0.05;

/// One world of a live run. A clone shares what is recorded.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Track {
    pub simulation: Simulation,
    pub recording: Recording,
    pub curve: Curve,
    /// What of the record can be shown without computing.
    #[serde(skip)]
    pub film: Film,
    /// Sums over the steps up to the present moment.
    pub tally: Tally,
    /// Mean time that a step takes, s.
    #[serde(skip)]
    pub step_secs: f64,
    /// Why the last step was no success.
    pub failure: Option<Arc<str>>,
    /// The simulated time that a seek is on its way to, s.
    #[serde(skip)]
    goal_secs: Option<f64>,
}

impl Track {
    /// A world at a start, with the sums of steps before it.
    pub(super) fn new(
        (start, tally): (&Simulation, Tally),
        variant: &Settings,
        budget_bytes: usize,
    ) -> Self {
        let mut simulation = start.clone();
        // A variant is checked where it is made; what is refused here stays as the start has it.
        let _ = simulation.change(*variant);
        let mut curve = Curve::default();
        curve.push(*simulation.observables());
        Self {
            recording: Recording::new(&simulation, tally, budget_bytes),
            simulation,
            curve,
            film: Film::default(),
            tally,
            step_secs: 0.0,
            failure: None,
            goal_secs: None,
        }
    }

    pub(super) fn variant(&self) -> Settings {
        *self.simulation.settings()
    }

    pub(super) fn time_secs(&self) -> f64 {
        self.simulation.time_secs()
    }

    pub(super) fn time_step_secs(&self) -> f64 {
        self.simulation.parameters().time_step_secs
    }

    /// Takes a step that is recorded, as it was. Whether it succeeded.
    fn step_in_the_record(&mut self) -> bool {
        self.recording.restore_controls(&mut self.simulation);
        let before = Instant::now();
        let is_taken = self.replay_step();
        self.note_duration(before.elapsed().as_secs_f64());
        if !self.recording.is_before_end(&self.simulation) {
            self.simulation.set_pull(None);
        }
        is_taken
    }

    /// Whether its next step leaves what is recorded behind.
    pub(super) fn branches(&self) -> bool {
        self.recording.is_before_end(&self.simulation) && !self.recording.replays(&self.simulation)
    }

    /// Takes a step and records it, unless it is one that is recorded. Whether it succeeded.
    pub(super) fn step(&mut self) -> bool {
        if self.failure.is_some() {
            return false;
        }
        if self.recording.replays(&self.simulation) {
            return self.step_in_the_record();
        }
        let step = self.simulation.observables().step;
        self.recording.before_step(&self.simulation, &self.tally);
        self.curve.truncate(step);
        let before = Instant::now();
        let outcome = self.simulation.step().copied();
        self.note_duration(before.elapsed().as_secs_f64());
        self.recording.after_step(&self.simulation);
        match outcome {
            Ok(observables) => {
                self.tally.add(&observables);
                self.curve.push(observables);
                self.film.store(&self.simulation, &self.tally, false);
                true
            }
            Err(error) => {
                self.failure = Some(error.to_string().into());
                false
            }
        }
    }

    fn note_duration(&mut self, secs: f64) {
        let weight = if self.step_secs == 0.0 { 1.0 } else { NEWEST };
        self.step_secs += weight * (secs - self.step_secs);
    }

    /// Steps until the time of the world is the one nearest to `time_secs`. Whether all succeeded.
    pub(super) fn catch_up(&mut self, time_secs: f64) -> bool {
        while self.time_secs() + 0.5 * self.time_step_secs() < time_secs {
            if !self.step() {
                return false;
            }
        }
        true
    }

    /// Starts on the way to a recorded moment.
    pub(super) fn seek(&mut self, time_secs: f64) {
        if self.failure.is_none() {
            self.recording.keep_end(&self.simulation, &self.tally);
        }
        let (keyframe, tally) = self.recording.keyframe_before(time_secs);
        self.simulation.clone_from(keyframe);
        self.tally = tally;
        self.failure = None;
        self.goal_secs = Some(time_secs);
        self.recording.restore_controls(&mut self.simulation);
    }

    /// Takes one step of a seek. Whether it has arrived.
    pub(super) fn advance_seek(&mut self) -> bool {
        let Some(goal) = self.goal_secs else { return true };
        if self.recording.has_come_to(&self.simulation, goal) || !self.replay_step() {
            self.goal_secs = None;
            // The hand that pulled a grain back then is not there when the run goes on from here.
            self.simulation.set_pull(None);
            return true;
        }
        false
    }

    fn replay_step(&mut self) -> bool {
        match self.simulation.step() {
            Ok(observables) => {
                self.tally.add(observables);
                self.film.store(&self.simulation, &self.tally, true);
                self.recording.restore_controls(&mut self.simulation);
                true
            }
            Err(error) => {
                self.failure = Some(error.to_string().into());
                false
            }
        }
    }

    /// All that the world has come to, for whoever takes it down.
    pub(super) fn taken(&self) -> Taken {
        let mut simulation = self.simulation.clone();
        // The hand is not there when the run goes on from here.
        simulation.set_pull(None);
        Taken {
            simulation,
            tally: self.tally,
            failure: self.failure.clone(),
            replay: Replay::of(self.recording.clone()),
        }
    }
}
