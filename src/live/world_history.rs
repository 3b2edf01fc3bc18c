//! One world (simulation) of a live run: its present state, the record of its steps, and the observables (measured
//! quantities) after these steps.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::stored_moments::StoredMoments;
use super::{Curve, WorldRecord};
use crate::Instant;
use crate::error::{Error, Result};
use crate::sim::{Edit, Settings, Simulation, Tally};

/// Weight (0 to 1) of the newest step in the running mean of the wall-clock time per step. With a larger weight the
/// mean fluctuates more; with a smaller weight it follows a change later.
const NEWEST: f64 = 0.05;

/// One world (simulation) of a live run, with the record of its steps. A clone shares memory with the original: the
/// copies of states in the record (keyframes) and most of the observables in the curve.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WorldHistory {
    /// The simulation in its present state.
    pub simulation: Simulation,
    /// The record of the steps up to the present state and, after a jump back in time, also of the steps after it.
    #[serde(rename = "recording")]
    pub record: WorldRecord,
    /// Observables (measured quantities) after each recorded step, for plots.
    pub curve: Curve,
    /// Stored snapshots, which can be shown without computing.
    #[serde(skip)]
    pub(super) stored: StoredMoments,
    /// Sums over the steps up to the present state, such as the number of unsolved steps.
    pub tally: Tally,
    #[serde(skip)]
    pub(super) step_secs: f64,
    /// The reason why the simulation cannot continue from the present state; `None` if it can.
    pub failure: Option<Arc<str>>,
    /// Simulated time to which a seek (a jump to a recorded time) leads, s.
    #[serde(skip)]
    goal_secs: Option<f64>,
}

impl WorldHistory {
    /// Returns a simulation at the state `start` with these settings. `tally` contains the sums over the steps before
    /// `start`, such as the number of unsolved steps. `budget_bytes` is the memory for keyframes (copies of the state),
    /// bytes.
    pub(super) fn new(
        start: &Simulation,
        tally: Tally,
        settings: &Settings,
        budget_bytes: usize,
    ) -> Self {
        let mut simulation = start.clone();
        // Settings are checked when they are made. If a setting is nevertheless refused here, the setting of `start`
        // remains.
        let _ = simulation.change(*settings);
        let mut curve = Curve::default();
        curve.push(*simulation.observables());
        Self {
            record: WorldRecord::new(&simulation, tally, budget_bytes),
            simulation,
            curve,
            stored: StoredMoments::default(),
            tally,
            step_secs: 0.0,
            failure: None,
            goal_secs: None,
        }
    }

    /// The number of the step that led to the present state.
    pub(super) fn steps(&self) -> u64 {
        self.simulation.observables().step
    }

    pub(super) fn time_step_secs(&self) -> f64 {
        self.simulation.parameters().time_step_secs
    }

    /// True if later steps are recorded, but the next step does not repeat them, because the present settings differ
    /// from the recorded settings.
    pub(super) fn branches(&self) -> bool {
        self.record.is_before_end(&self.simulation) && !self.record.replays(&self.simulation)
    }

    /// Takes a step, and records the step unless it repeats a recorded step. Returns false if the step fails.
    pub(super) fn step(&mut self) -> bool {
        if self.failure.is_some() {
            return false;
        }
        if self.record.replays(&self.simulation) {
            return self.step_in_the_record();
        }
        self.record.before_step(&self.simulation, &self.tally);
        self.curve.truncate(self.steps());
        let before = Instant::now();
        let stepped = self.simulation.step().copied();
        self.note_duration(before.elapsed().as_secs_f64());
        self.record.after_step(&self.simulation);
        match stepped {
            Ok(observables) => {
                self.tally.add(&observables);
                self.curve.push(observables);
                self.stored.store(&self.simulation, &self.tally, false);
            }
            Err(error) => self.failure = Some(error.to_string().into()),
        }
        self.failure.is_none()
    }

    /// Takes a step that repeats a recorded step. Returns false if the step fails.
    fn step_in_the_record(&mut self) -> bool {
        self.record.restore_controls(&mut self.simulation);
        let before = Instant::now();
        let is_taken = self.replay_step();
        self.note_duration(before.elapsed().as_secs_f64());
        if !self.record.is_before_end(&self.simulation) {
            self.simulation.set_pull(None);
        }
        is_taken
    }

    fn replay_step(&mut self) -> bool {
        match self.simulation.step() {
            Ok(observables) => {
                self.tally.add(observables);
                self.stored.store(&self.simulation, &self.tally, true);
                self.record.restore_controls(&mut self.simulation);
            }
            Err(error) => self.failure = Some(error.to_string().into()),
        }
        self.failure.is_none()
    }

    fn note_duration(&mut self, secs: f64) {
        let weight = if self.step_secs == 0.0 { 1.0 } else { NEWEST };
        self.step_secs += weight * (secs - self.step_secs);
    }

    /// True if another step brings the simulated time closer to `time_secs`, s.
    pub(super) fn is_before(&self, time_secs: f64) -> bool {
        self.simulation.time_secs() + 0.5 * self.time_step_secs() < time_secs
    }

    /// Takes at least one step, and further steps until the simulated time is nearest to `time_secs`, s, or the wall
    /// clock reaches `until`. Returns false if a step failed.
    pub(super) fn catch_up(&mut self, time_secs: f64, until: Instant) -> bool {
        while self.is_before(time_secs) {
            if !self.step() {
                return false;
            }
            if Instant::now() >= until {
                break;
            }
        }
        true
    }

    /// Starts to compute the recorded state nearest to the simulated time `time_secs`, s (a seek).
    pub(super) fn seek(&mut self, time_secs: f64) {
        if self.failure.is_none() {
            self.record.keep_end(&self.simulation, &self.tally);
        }
        let (keyframe, tally) = self.record.keyframe_before(time_secs);
        self.simulation.clone_from(keyframe);
        self.tally = tally;
        self.failure = None;
        self.goal_secs = Some(time_secs);
        self.record.restore_controls(&mut self.simulation);
    }

    /// Takes one step of a seek (a jump to a recorded time). Returns true when the seek has reached its time.
    pub(super) fn advance_seek(&mut self) -> bool {
        let Some(goal) = self.goal_secs else { return true };
        if self.record.has_come_to(&self.simulation, goal) || !self.replay_step() {
            self.goal_secs = None;
            // The recorded pull of a grain ends at this moment.
            self.simulation.set_pull(None);
            return true;
        }
        false
    }

    /// Applies a user's edit (for example, a moved grain). Later recorded steps are no longer valid, so they are
    /// removed.
    pub(super) fn edit(&mut self, edit: Edit) -> Result<()> {
        if let Some(failure) = &self.failure {
            return Err(Error::value("state", failure, "one from which the run can continue"));
        }
        self.simulation.edit(&edit)?;
        self.record.edited(&self.simulation, edit);
        self.curve.truncate(self.steps());
        self.stored.forget_from(self.steps());
        Ok(())
    }

    /// Copy of the history without stored snapshots (past states kept for display), to be sent to the window or to a
    /// file.
    pub(super) fn handed_out(&self) -> Self {
        let mut world = Self { stored: StoredMoments::default(), ..self.clone() };
        // The user's pull of a grain ends here.
        world.simulation.set_pull(None);
        world
    }
}
