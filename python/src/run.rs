//! A run of a simulation from Python, with its history of steps, its sums of pair forces and its recording.

use std::path::{Path, PathBuf};
use std::process;
use std::time::{Duration, Instant};

use slump_core::error::{self, Result};
use slump_core::scene::Scene;
use slump_core::sim::{Alarm, AlarmKind, ForceSums, Observables, Simulation, Tally};
use slump_data::config::SavedState;
use slump_data::config::scene_facts;
use slump_data::data::{DataSettings, FrameSchedule, Recording, Times, formats_of};

/// Time for which steps are taken between two checks for Ctrl-C. With a longer time, Ctrl-C reacts noticeably late.
/// With a shorter time, the checks cost more, because each check waits for Python's lock.
const SLICE: Duration = Duration::from_millis(20);

/// A run of a scene: the simulation, its history and its recording.
pub(crate) struct Run {
    /// Scene with which the run began.
    pub scene: Scene,
    /// The simulation in its present state.
    pub simulation: Simulation,
    /// Observables, one row per step since the start of the run or since the history was last deleted.
    pub rows: Vec<Observables>,
    /// Sums of the forces of pairs; `None` until `begin_pairs` is called.
    pub sums: Option<ForceSums>,
    /// Statistics over all steps of the run.
    tally: Tally,
    /// The recording and the id of the process that started it; `None` without a recording.
    recording: Option<(u32, Recording)>,
    /// Number of alarms that have already been reported.
    alarms_told: usize,
}

/// Result of taking several steps.
pub(crate) struct Taken {
    /// Number of steps that were taken.
    pub steps: u64,
    /// True if the callback is due after the last step.
    pub is_due: bool,
    /// The error that stopped the run, if there was one.
    pub ended: Result<()>,
}

impl Run {
    /// Starts a run of a scene from its initial state.
    pub(crate) fn start(scene: Scene) -> Result<Self> {
        let simulation = scene.simulation()?;
        Ok(Self::of(SavedState::new(scene, simulation, Tally::default())))
    }

    /// Resumes a run from a saved state.
    pub(crate) fn of(state: SavedState) -> Self {
        let SavedState { scene, simulation, tally, .. } = state;
        // The alarms of this state were reported before it was saved.
        let alarms_told = simulation.alarms().len();
        let (rows, sums) = (Vec::new(), None);
        Self { scene, simulation, rows, sums, tally, recording: None, alarms_told }
    }

    /// Returns the complete present state, without the history of the steps. Fails if the state is no longer finite.
    pub(crate) fn saved(&self) -> Result<SavedState> {
        self.check_finite("finite where it is saved")?;
        Ok(SavedState::new(self.scene.clone(), self.simulation.clone(), self.tally))
    }

    /// Checks that the state is still finite. `allowed` is the allowed value in the error message.
    fn check_finite(&self, allowed: &str) -> Result<()> {
        let is_finite = |alarm: &Alarm| alarm.kind != AlarmKind::NotFinite;
        let found = "no longer finite";
        error::check(self.simulation.alarms().iter().all(is_finite), "state", found, allowed)
    }

    /// Returns a second run in the same state, without the recording.
    pub(crate) fn copy(&self) -> Self {
        Self {
            scene: self.scene.clone(),
            simulation: self.simulation.clone(),
            rows: self.rows.clone(),
            sums: self.sums.clone(),
            tally: self.tally,
            recording: None,
            alarms_told: self.alarms_told,
        }
    }

    /// Starts to sum the forces of pairs from the present state on.
    pub(crate) fn begin_pairs(&mut self) {
        let mut sums = ForceSums::default();
        sums.follow(&self.simulation);
        self.sums = Some(sums);
    }

    /// Starts the sums of pair forces again from zero after an edit, which may have changed the indices of bodies.
    pub(crate) fn edited(&mut self) {
        if let Some(sums) = &mut self.sums {
            sums.follow(&self.simulation);
        }
    }

    /// Starts a recording in `folder`, from the present state on.
    pub(crate) fn record(
        &mut self,
        folder: &Path,
        settings: &DataSettings,
        overwrite: bool,
    ) -> Result<()> {
        settings.validate("every")?;
        self.check_finite("finite to be recorded")?;
        let mut now = self.scene.clone();
        now.set_settings(*self.simulation.settings());
        let recording =
            Recording::start(folder, &formats_of(settings)?, &scene_facts(&now)?, overwrite)?;
        let mut recording = recording.at(Times::of(settings), &self.simulation);
        recording.add_if_due(&self.simulation)?;
        self.recording = Some((process::id(), recording));
        Ok(())
    }

    /// Ends the recording, if there is one, and waits until it is written.
    pub(crate) fn end_recording(&mut self) -> Result<()> {
        self.leave_recording_to_parent();
        self.recording.take().map_or(Ok(()), |(_, recording)| recording.finish())
    }

    /// Returns the folder of the recording, if there is one.
    pub(crate) fn recording_folder(&mut self) -> Option<PathBuf> {
        self.leave_recording_to_parent();
        self.recording.as_ref().map(|(_, recording)| recording.folder().to_owned())
    }

    /// Drops a recording that belongs to another process, of which this process is a fork. The thread that writes the
    /// recording exists only in the other process, and the folder is locked for that process. So not even a destructor
    /// may run here.
    fn leave_recording_to_parent(&mut self) {
        if self.recording.as_ref().is_some_and(|(owner, _)| *owner != process::id()) {
            std::mem::forget(self.recording.take());
        }
    }

    /// Takes at most `most` steps, for the time [`SLICE`], and stops after a step at which `schedule` is due.
    pub(crate) fn take(&mut self, most: u64, mut schedule: Option<&mut FrameSchedule>) -> Taken {
        let start = Instant::now();
        let mut taken = Taken { steps: 0, is_due: false, ended: Ok(()) };
        while taken.steps < most && start.elapsed() < SLICE {
            let stepped = self.simulation.step().map(|_| ());
            let taken_down = self.take_down(stepped.is_ok());
            taken.steps += 1;
            taken.ended = stepped.and(taken_down);
            let due = |schedule: &mut &mut FrameSchedule| schedule.is_due(&self.simulation);
            taken.is_due = schedule.as_mut().is_some_and(due);
            if taken.ended.is_err() || taken.is_due {
                break;
            }
        }
        taken
    }

    /// Adds the observables of the last step to the history and to the recording, and records the state if it is
    /// finite. As in `observables.csv`, a step whose state is not finite also gets a row.
    fn take_down(&mut self, is_finite: bool) -> Result<()> {
        let row = *self.simulation.observables();
        self.rows.push(row);
        if let Some(sums) = &mut self.sums {
            sums.follow(&self.simulation);
        }
        self.tally.add(&row);
        self.leave_recording_to_parent();
        let Some((_, recording)) = &mut self.recording else { return Ok(()) };
        let mut taken = recording.add_step(&row);
        if is_finite {
            taken = taken.and_then(|()| recording.add_if_due(&self.simulation));
        }
        if taken.is_err() {
            self.recording = None;
        }
        taken
    }

    /// Returns one sentence for each alarm so far.
    pub(crate) fn alarms(&self) -> Vec<String> {
        let settings = self.simulation.settings();
        self.simulation.alarms().iter().map(|alarm| alarm.message(settings)).collect()
    }

    /// Returns the alarms since the last call, each with its kind and a sentence.
    pub(crate) fn new_alarms(&mut self) -> Vec<(AlarmKind, String)> {
        let settings = self.simulation.settings();
        let new = self.simulation.alarms().iter().skip(self.alarms_told);
        let new: Vec<_> = new.map(|alarm| (alarm.kind, alarm.message(settings))).collect();
        self.alarms_told += new.len();
        new
    }
}

impl Drop for Run {
    fn drop(&mut self) {
        // Write the waiting rows if the recording was not ended. Errors are dropped here; `end_recording` reports them.
        let _ = self.end_recording();
    }
}
