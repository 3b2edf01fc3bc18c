//! A simulation with what is kept of its steps.

use std::path::{Path, PathBuf};
use std::process;
use std::time::{Duration, Instant};

use slump_core::error::{self, Result};
use slump_core::scene::Scene;
use slump_core::sim::{Alarm, AlarmKind, ForceSums, Observables, Simulation, Tally};
use slump_data::config::SavedState;
use slump_data::config::scene_facts;
use slump_data::data::{DataSettings, FrameSchedule, Recording, Times, formats_of};

/// How long steps are taken before someone looks for Ctrl-C. Longer is felt when it is pressed; shorter costs
/// more looks, each of which waits for Python's lock.
const SLICE: Duration = Duration::from_millis(20);

/// A run of a scene.
pub(crate) struct Run {
    /// The scene as it began.
    pub scene: Scene,
    /// The run itself.
    pub simulation: Simulation,
    /// A row a step, since the start or since they were last forgotten.
    pub rows: Vec<Observables>,
    /// What pairs transmitted since that was begun, if it was.
    pub sums: Option<ForceSums>,
    /// Sums over all of its steps.
    tally: Tally,
    /// Where it is recorded, if it is, and the process that began to record it.
    recording: Option<(u32, Recording)>,
    /// How many alarms have been told of.
    alarms_told: usize,
}

/// Steps that were taken one after the other.
pub(crate) struct Taken {
    /// Their number.
    pub steps: u64,
    /// True if a schedule is due at the last step.
    pub is_due: bool,
    /// The error that ended them, if one did.
    pub ended: Result<()>,
}

impl Run {
    /// A run at its start.
    pub(crate) fn start(scene: Scene) -> Result<Self> {
        let simulation = scene.simulation()?;
        Ok(Self::of(SavedState::new(scene, simulation, Tally::default())))
    }

    /// A run that goes on from a saved state.
    pub(crate) fn of(state: SavedState) -> Self {
        let SavedState { scene, simulation, tally, .. } = state;
        // Who saved it has been told of these.
        let alarms_told = simulation.alarms().len();
        let (rows, sums) = (Vec::new(), None);
        Self { scene, simulation, rows, sums, tally, recording: None, alarms_told }
    }

    /// All of it as it is now, but for the rows of its steps.
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

    /// A second one, which goes on as this one would, but is not recorded.
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

    /// Begins to sum up what pairs transmit.
    pub(crate) fn begin_pairs(&mut self) {
        let mut sums = ForceSums::default();
        sums.follow(&self.simulation);
        self.sums = Some(sums);
    }

    /// Has sums of pairs begin again if bodies have other numbers now.
    pub(crate) fn edited(&mut self) {
        if let Some(sums) = &mut self.sums {
            sums.follow(&self.simulation);
        }
    }

    /// Records it from its present state on.
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

    /// Ends its recording, if there is one.
    pub(crate) fn end_recording(&mut self) -> Result<()> {
        self.leave_recording_to_parent();
        self.recording.take().map_or(Ok(()), |(_, recording)| recording.finish())
    }

    /// The folder that it is recorded in, if it is.
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

    /// Takes steps for a while, at most `most`, and none after a step at which `schedule` is due.
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

    /// Keeps what a step measured, and records its state unless it blew up; the row of one that did is one
    /// of them, as in `observables.csv`.
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

    /// What went wrong so far, one sentence of a kind.
    pub(crate) fn alarms(&self) -> Vec<String> {
        let settings = self.simulation.settings();
        self.simulation.alarms().iter().map(|alarm| alarm.message(settings)).collect()
    }

    /// What went wrong since the last call: its kind, and a sentence.
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
        // The rows that wait are written where nobody ended the recording; whoever wants to know what went
        // wrong ends it.
        let _ = self.end_recording();
    }
}
