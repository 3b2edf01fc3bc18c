//! The record of a simulation, from which each of its past states can be computed again with the same bits.
//!
//! A step depends only on the state and the settings, and a clone of a simulation continues exactly like the original.
//! So a record consists of some clones (keyframes) and of all changes of the settings. A state between two keyframes is
//! computed from the keyframe before it. If the memory for keyframes is full, every second keyframe is dropped. Then
//! the whole run can still be computed, with more steps from the nearest keyframe.

use std::ops::ControlFlow;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::sim::{Edit, Pull, RunEnding, Settings, Simulation, Tally};

/// The inputs of a simulation that a user can change between two steps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Controls {
    /// Settings of the next step.
    pub settings: Settings,
    /// Spring by which the user drags a grain; `None` if the user drags no grain.
    pub pull: Option<Pull>,
}

impl Controls {
    /// Returns the controls (settings and pull of a grain) of a simulation's next step.
    pub(super) fn of(simulation: &Simulation) -> Self {
        Self { settings: *simulation.settings(), pull: simulation.pull() }
    }
}

/// A change of the controls (settings or pull of a grain) between two steps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ControlsChange {
    /// Number of the last step before the user changed the settings or the pull of the mouse.
    pub after_step: u64,
    /// Simulated time of the change (the end of the last step before it), s.
    pub time_secs: f64,
    /// The new controls (settings and pull of a grain), which apply until the next change.
    pub controls: Controls,
}

/// A user's edit of a simulation between two steps, for example a moved grain.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HandEdit {
    /// Number of the last step before the edit.
    pub after_step: u64,
    /// The edit.
    pub edit: Edit,
}

/// Initial number of steps between keyframes (copies of the state); it doubles when the memory for keyframes is full.
const FIRST_SPACING: u64 = 32;

/// The record of one simulation: keyframes (copies of the state), and the changes of the settings and edits between
/// them. Clones share the keyframes, so a clone is cheap. States between keyframes are computed from the nearest
/// earlier keyframe.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WorldRecord {
    keyframes: Vec<Keyframe>,
    changes: Vec<ControlsChange>,
    /// Edits by the user, in order of time. The state of a simulation contains the number of its edits, so that edits
    /// still to be applied can be found.
    edits: Vec<HandEdit>,
    spacing: u64,
    budget_bytes: usize,
    end_step: u64,
    end_secs: f64,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Keyframe {
    simulation: Arc<Simulation>,
    tally: Tally,
}

impl Keyframe {
    fn step(&self) -> u64 {
        self.simulation.observables().step
    }
}

impl WorldRecord {
    /// Returns a record that begins at the state `start`. `tally` contains the sums over the steps before `start`, such
    /// as the number of unsolved steps. `budget_bytes` is the approximate memory for keyframes (copies of the state),
    /// bytes.
    pub(super) fn new(start: &Simulation, tally: Tally, budget_bytes: usize) -> Self {
        Self {
            keyframes: vec![Keyframe { simulation: Arc::new(start.clone()), tally }],
            changes: Vec::new(),
            edits: Vec::new(),
            spacing: FIRST_SPACING,
            budget_bytes,
            end_step: start.observables().step,
            end_secs: start.time_secs(),
        }
    }

    /// Simulated time of the last recorded step, s.
    pub fn end_secs(&self) -> f64 {
        self.end_secs
    }

    /// The first recorded state.
    pub fn start(&self) -> &Simulation {
        // A record is created with its first keyframe, and `thin` always keeps the first keyframe.
        &self.keyframes[0].simulation
    }

    /// Records the state before a new step. If later steps were recorded, they are removed from the record.
    pub(super) fn before_step(&mut self, simulation: &Simulation, tally: &Tally) {
        let step = simulation.observables().step;
        self.cut(step, self.edits_of(simulation));
        let controls = Controls::of(simulation);
        if self.changes.last().is_none_or(|last| last.controls != controls) {
            let time_secs = simulation.time_secs();
            self.changes.push(ControlsChange { after_step: step, time_secs, controls });
        }
        if step >= self.last_keyframe() + self.spacing {
            self.keep(simulation, tally);
        }
    }

    fn last_keyframe(&self) -> u64 {
        self.keyframes.last().map_or(0, Keyframe::step)
    }

    fn keep(&mut self, simulation: &Simulation, tally: &Tally) {
        let simulation = Arc::new(simulation.clone());
        self.keyframes.push(Keyframe { simulation, tally: *tally });
        if !self.is_within_budget() {
            self.thin();
        }
    }

    /// Removes everything that was recorded after the step number `step`, and all edits except the first `edits`.
    fn cut(&mut self, step: u64, edits: usize) {
        if self.end_step > step {
            let begun_with = self.start().edits();
            let is_before = |keyframe: &Keyframe| {
                keyframe.step() <= step && keyframe.simulation.edits() - begun_with <= edits
            };
            self.keyframes.retain(is_before);
            self.changes.retain(|change| change.after_step < step);
            self.end_step = step;
        }
        self.edits.truncate(edits);
    }

    /// Records a user's edit (for example, a moved grain) that led to the state of `simulation`. Later steps are no
    /// longer valid, so they are removed from the record.
    pub(super) fn edited(&mut self, simulation: &Simulation, edit: Edit) {
        let after_step = simulation.observables().step;
        self.cut(after_step, self.edits_of(simulation).saturating_sub(1));
        self.end_secs = simulation.time_secs();
        self.edits.push(HandEdit { after_step, edit });
    }

    /// Number of this record's edits (for example, moved grains) that were already applied to the state of
    /// `simulation`.
    fn edits_of(&self, simulation: &Simulation) -> usize {
        simulation.edits().saturating_sub(self.start().edits())
    }

    /// All edits by the user (for example, moved grains), in order of time.
    pub fn edits(&self) -> &[HandEdit] {
        &self.edits
    }

    /// Keeps a keyframe (a copy of the state) at the end of the record, so that a later jump to the end computes
    /// nothing.
    pub(super) fn keep_end(&mut self, simulation: &Simulation, tally: &Tally) {
        let step = simulation.observables().step;
        if step == self.end_step && self.last_keyframe() < step {
            self.keep(simulation, tally);
        }
    }

    /// Records that `simulation` has just finished a step.
    pub(super) fn after_step(&mut self, simulation: &Simulation) {
        self.end_step = simulation.observables().step;
        self.end_secs = simulation.time_secs();
    }

    fn thin(&mut self) {
        self.spacing *= 2;
        let mut index = 0;
        self.keyframes.retain(|_| {
            index += 1;
            index % 2 == 1
        });
    }

    fn is_within_budget(&self) -> bool {
        self.keyframes.len() < 3 || self.bytes() <= self.budget_bytes
    }

    /// Approximate memory of the keyframes (copies of the state), bytes.
    pub(super) fn bytes(&self) -> usize {
        let newest = self.keyframes.last().map(|keyframe| &keyframe.simulation);
        newest.map_or(0, |newest| self.keyframes.len() * memory_bytes(newest))
    }

    /// Limits the memory of the keyframes (copies of the state) to about `budget_bytes` bytes.
    pub(super) fn keep_within(&mut self, budget_bytes: usize) {
        self.budget_bytes = budget_bytes;
        while !self.is_within_budget() {
            self.thin();
        }
    }

    /// True if a record that was read from a file is consistent: it has a keyframe (a copy of the state); keyframes,
    /// changes of settings and edits are in the order of their step numbers; and no keyframe is later than the last
    /// step.
    pub(super) fn is_sound(&self) -> bool {
        let rise = |pair: &[Keyframe]| pair[0].step() < pair[1].step();
        let last = self.keyframes.last().map(Keyframe::step);
        let changes = self.changes.windows(2);
        last.is_some_and(|last| last <= self.end_step)
            && self.spacing > 0
            && self.keyframes.windows(2).all(rise)
            && self.edits.is_sorted_by_key(|made| made.after_step)
            && changes.into_iter().all(|pair| pair[0].after_step < pair[1].after_step)
    }

    /// True if the record contains at least one step.
    pub(super) fn has_steps(&self) -> bool {
        self.end_step > self.start().observables().step
    }

    /// True if all recorded steps have these settings, and the user neither edited the simulation nor pulled a grain.
    pub(super) fn is_all_with(&self, settings: &Settings) -> bool {
        let all_along = Controls { settings: *settings, pull: None };
        self.edits.is_empty() && self.changes.iter().all(|change| change.controls == all_along)
    }

    /// True if the next step of a simulation repeats a recorded step: a later step is recorded, with the present
    /// settings, and the user pulls no grain or pulls a grain exactly as recorded. A recorded pull may be missing now,
    /// because a jump to a recorded time removes pulls.
    pub(super) fn replays(&self, simulation: &Simulation) -> bool {
        let step = simulation.observables().step;
        let same = |recorded: &Controls| {
            let now = Controls::of(simulation);
            now.settings == recorded.settings && (now.pull.is_none() || now.pull == recorded.pull)
        };
        self.is_before_end(simulation) && self.controls_after(step).is_some_and(same)
    }

    /// True if steps after the state of `simulation` are recorded.
    pub(super) fn is_before_end(&self, simulation: &Simulation) -> bool {
        simulation.observables().step < self.end_step
    }

    /// Returns the last keyframe (copy of the state) at or before a simulated time, s, and the sums over the steps up
    /// to that keyframe, such as the number of unsolved steps.
    pub(super) fn keyframe_before(&self, time_secs: f64) -> (&Simulation, Tally) {
        let after = |keyframe: &Keyframe| keyframe.simulation.time_secs() <= time_secs;
        let index = self.keyframes.partition_point(after).saturating_sub(1);
        let keyframe = &self.keyframes[index];
        (&keyframe.simulation, keyframe.tally)
    }

    /// True if `simulation` need not take another recorded step to reach the simulated time `goal_secs`, s: its time is
    /// at most half a time step before `goal_secs`, or there is no later recorded step.
    pub(super) fn has_come_to(&self, simulation: &Simulation, goal_secs: f64) -> bool {
        let step = simulation.observables().step;
        let controls = self.controls_after(step).copied();
        let settings = controls.unwrap_or_else(|| Controls::of(simulation)).settings;
        self.is_at(step, simulation.time_secs(), settings.parameters.time_step_secs, goal_secs)
    }

    fn is_at(&self, step: u64, time_secs: f64, time_step_secs: f64, goal_secs: f64) -> bool {
        time_secs + 0.5 * time_step_secs >= goal_secs || step >= self.end_step
    }

    /// Prepares a recorded state for its next recorded step: applies the recorded edits that precede this step, and
    /// sets the recorded controls (settings and pull of a grain).
    pub(super) fn restore_controls(&self, simulation: &mut Simulation) {
        let step = simulation.observables().step;
        let made = self.edits.iter().skip(self.edits_of(simulation));
        for made in made.take_while(|made| made.after_step <= step) {
            // The edits were accepted when they were recorded.
            let _ = simulation.edit(&made.edit);
        }
        if let Some(Controls { settings, pull }) = self.controls_after(step).copied() {
            // The settings were accepted when they were recorded.
            let _ = simulation.change(settings);
            simulation.set_pull(pull);
        }
    }

    /// The settings of the recorded step with this number; `None` if no settings are recorded for it.
    pub(super) fn settings_of_step(&self, step: u64) -> Option<Settings> {
        Some(self.controls_after(step.checked_sub(1)?)?.settings)
    }

    /// The controls (settings and pull of a grain) of the step that follows step number `step`; `None` before the first
    /// recorded change.
    pub(super) fn controls_after(&self, step: u64) -> Option<&Controls> {
        let count = self.changes.partition_point(|change| change.after_step <= step);
        count.checked_sub(1).map(|index| &self.changes[index].controls)
    }

    /// Returns the changes of the controls (settings and pull of a grain) from step `from_step` on that affect steps up
    /// to the simulated time `until_secs`, s.
    pub fn changes(
        &self,
        from_step: u64,
        until_secs: f64,
    ) -> impl Iterator<Item = &ControlsChange> {
        self.changes.iter().filter(move |change| {
            let ControlsChange { after_step, time_secs, controls } = **change;
            let time_step_secs = controls.settings.parameters.time_step_secs;
            after_step >= from_step
                && !self.is_at(after_step, time_secs, time_step_secs, until_secs)
        })
    }

    /// Computes the states between two simulated times, s, again with the same bits. The callback `each` receives all
    /// states in order of time, starting at the last keyframe (stored copy of the state) before the first time. Its
    /// second argument is true if the state lies between the two times. Each state has the settings of the step that
    /// led to it. The callback can end the replay.
    ///
    /// # Errors
    /// Returns an error of the callback or of a step. If a state is no longer finite, the replay ends without an error.
    pub fn replay(
        &self,
        [from_secs, until_secs]: [f64; 2],
        mut each: impl FnMut(&Simulation, bool) -> Result<ControlFlow<()>>,
    ) -> Result<RunEnding> {
        let is_before = |keyframe: &Keyframe| !self.has_come_to(&keyframe.simulation, from_secs);
        let index = self.keyframes.partition_point(is_before).saturating_sub(1);
        let mut simulation = Simulation::clone(&self.keyframes[index].simulation);
        if simulation.observables().step == 0 {
            // No step led to the initial state, so the initial state gets the settings of the first step.
            self.restore_controls(&mut simulation);
        }
        loop {
            let is_within = self.has_come_to(&simulation, from_secs);
            if each(&simulation, is_within)?.is_break() {
                return Ok(RunEnding::Stopped);
            }
            if self.has_come_to(&simulation, until_secs) {
                return Ok(RunEnding::Done);
            }
            self.restore_controls(&mut simulation);
            match simulation.step() {
                Ok(_) => {}
                Err(failure @ Error::NonFinite { .. }) => return Ok(RunEnding::NotFinite(failure)),
                Err(error) => return Err(error),
            }
        }
    }
}

/// Approximate memory of a clone of a simulation, bytes.
fn memory_bytes(simulation: &Simulation) -> usize {
    // Measured on piles of 138 to 10,000 grains: the lists of grains, bodies and candidate pairs take about 500 bytes
    // per grain, rows and impulses about 250 bytes per contact, and fixed shapes about 100 bytes each.
    let world = simulation.world();
    let fixed = world.fixed_discs.len() + world.boundaries.len();
    4096 + 500 * world.grains.len() + 250 * simulation.contacts().contacts().len() + 100 * fixed
}
