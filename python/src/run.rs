//! A simulation together with its history, pair sums and recording.

use std::path::{Path, PathBuf};
use std::process;
use std::time::{Duration, Instant};

use slump_core::error::{self, Result};
use slump_core::scene::Scene;
use slump_core::sim::{Alarm, AlarmKind, ForceSums, Observables, Simulation, Tally};
use slump_data::config::SavedState;
use slump_data::config::scene_facts;
use slump_data::data::{DataSettings, FrameSchedule, Recording, Times, formats_of};

/// Time for which steps are taken between two checks for Ctrl-C. If it is longer, Ctrl-C reacts noticeably late. If it
/// is shorter, more time is lost in checks, each of which waits for Python's lock.
const SLICE: Duration = Duration::from_millis(20);

/// A run of a scene.
pub(crate) struct Run {
    /// The scene with which the run began.
    pub scene: Scene,
    /// The simulation.
    pub simulation: Simulation,
    /// Observables, one row per step since the start or since the history was last deleted.
    pub rows: Vec<Observables>,
    /// Sums of the forces of pairs, once `begin_pairs` was called.
    pub sums: Option<ForceSums>,
    /// Sums over all steps of the run.
    tally: Tally,
    /// The recording, if there is one, and the process that started it.
    recording: Option<(u32, Recording)>,
    /// Number of alarms that were already reported.
    alarms_told: usize,
}

/// Result of taking several steps.
pub(crate) struct Taken {
    /// Number of steps.
    pub steps: u64,
    /// True if a schedule is due at the last step.
    pub is_due: bool,
    /// The error that stopped the run, if any.
    pub ended: Result<()>,
}

impl Run {
    /// Starts a run of a scene.
    pub(crate) fn start(scene: Scene) -> Result<Self> {
        let simulation = scene.simulation()?;
        Ok(Self::of(SavedState::new(scene, simulation, Tally::default())))
    }

    /// Resumes a run from a saved state.
    pub(crate) fn of(state: SavedState) -> Self {
        let SavedState { scene, simulation, tally, .. } = state;
        // These alarms were reported before the state was saved.
        let alarms_told = simulation.alarms().len();
        let (rows, sums) = (Vec::new(), None);
        Self { scene, simulation, rows, sums, tally, recording: None, alarms_told }
    }

    /// The complete present state, without the history of the steps.
    pub(crate) fn saved(&self) -> Result<SavedState> {
        self.check_finite("finite where it is saved")?;
        Ok(SavedState::new(self.scene.clone(), self.simulation.clone(), self.tally))
    }

    /// Refuses a state that is no longer finite.
    fn check_finite(&self, allowed: &str) -> Result<()> {
        let is_finite = |alarm: &Alarm| alarm.kind != AlarmKind::NotFinite;
        let found = "no longer finite";
        error::check(self.simulation.alarms().iter().all(is_finite), "state", found, allowed)
    }

    /// A second run in the same state, without the recording.
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

    /// Starts to sum the forces of pairs.
    pub(crate) fn begin_pairs(&mut self) {
        let mut sums = ForceSums::default();
        sums.follow(&self.simulation);
        self.sums = Some(sums);
    }

    /// Restarts the sums of pairs if bodies have been renumbered.
    pub(crate) fn edited(&mut self) {
        if let Some(sums) = &mut self.sums {
            sums.follow(&self.simulation);
        }
    }

    /// Starts a recording from the present state on.
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

    /// Ends the recording, if there is one.
    pub(crate) fn end_recording(&mut self) -> Result<()> {
        self.leave_recording_to_parent();
        self.recording.take().map_or(Ok(()), |(_, recording)| recording.finish())
    }

    /// The folder of the recording, if there is one.
    pub(crate) fn recording_folder(&mut self) -> Option<PathBuf> {
        self.leave_recording_to_parent();
        self.recording.as_ref().map(|(_, recording)| recording.folder().to_owned())
    }

    /// Forgets a recording that another process began, from which this process was forked. The thread that writes
    /// the recording exists in that process alone, and the folder is locked for it: not even a destructor may run here.
    fn leave_recording_to_parent(&mut self) {
        if self.recording.as_ref().is_some_and(|(owner, _)| *owner != process::id()) {
            std::mem::forget(self.recording.take());
        }
    }

    /// Takes steps for the time of a slice, at most `most` steps, and stops after a step at which `schedule` is due.
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

    /// Adds the observables of a step to the history and the recording, and records its state if it is finite. As in
    /// `observables.csv`, a step with a state that is not finite also gets a row.
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

    /// All alarms so far, one sentence for each kind.
    pub(crate) fn alarms(&self) -> Vec<String> {
        let settings = self.simulation.settings();
        self.simulation.alarms().iter().map(|alarm| alarm.message(settings)).collect()
    }

    /// Alarms since the last call, each with its kind and a sentence.
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
        // Writes the waiting rows if the recording was not ended. Errors are dropped; call `end_recording` to see them.
        let _ = self.end_recording();
    }
}
