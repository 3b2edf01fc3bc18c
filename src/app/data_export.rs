//! Recordings of what the window has computed. A thread of their own computes all of it once more and writes
//! it down, so that neither the window nor the run waits.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::mpsc::Receiver;

use serde::{Deserialize, Serialize};

use super::opening::{Opened, TakenRun};
use super::work::{Reporter, Work};
use crate::config::run_facts;
use crate::data::{
    DEFAULT_FORMAT, DataSettings, FormatName, Recording, RecordingFolder, RunFacts, Times,
    formats_of,
};
use crate::error::{Error, Result};
use crate::headless::recording_sentence;
use crate::live::{ControlsChange, HandEdit, WorldRecord};
use crate::sim::{Edit, Pull, RunEnding, Simulation};
use crate::world::Disc;

/// What outlives the window.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct DataChoices {
    /// The folder of the recording; below that of all files, unless it says otherwise.
    pub folder: PathBuf,
    /// Simulated time between two frames, s.
    pub every_secs: f64,
    /// A frame after each step, whatever `every_secs` says.
    pub each_step: bool,
    /// The files that are written.
    pub formats: Vec<FormatName>,
}

impl Default for DataChoices {
    fn default() -> Self {
        Self {
            folder: PathBuf::from("data"),
            every_secs: 0.01,
            each_step: false,
            formats: vec![DEFAULT_FORMAT],
        }
    }
}

impl DataChoices {
    /// As recordings are asked for.
    pub(crate) fn settings(&self) -> DataSettings {
        let every_secs = (!self.each_step).then_some(self.every_secs);
        DataSettings { folder: None, every_secs, formats: self.formats.clone() }
    }

    /// Whether files of a format are wanted.
    pub(crate) fn has(&self, format: FormatName) -> bool {
        self.formats.contains(&format)
    }

    /// Wants files of a format, or wants them no more.
    pub(crate) fn set(&mut self, format: FormatName, is_wanted: bool) {
        self.formats.retain(|other| *other != format);
        self.formats.extend(is_wanted.then_some(format));
    }
}

/// What the panel about data is busy with.
#[derive(Default)]
pub(crate) struct DataPanel {
    /// First and last simulated time of what is exported, s; all that is recorded where there are none.
    pub stretch: Option<[f64; 2]>,
    /// Whether an earlier recording in the folder is to be removed.
    pub overwrite: bool,
    /// The export that is going on.
    pub export: Option<Work>,
    /// What became of the last one, and whether it failed.
    pub told: Option<(String, bool)>,
    /// The file of a saved run, as it is typed.
    pub saved_run: String,
}

/// What is to be written.
pub(crate) struct DataOrder {
    /// Where to.
    pub folder: PathBuf,
    /// Whether an earlier recording there is removed.
    pub overwrite: bool,
    /// As what, and how often; after each step where no time between frames is given.
    pub settings: DataSettings,
    /// First and last simulated time, s; all that is recorded where none are given.
    pub stretch: Option<[f64; 2]>,
}

impl DataOrder {
    /// Starts an export of a run that is on its way.
    pub(crate) fn start(self, context: &egui::Context, run: Receiver<TakenRun>) -> Work {
        Work::start(context, move |reporter| write(&self, &run, reporter))
    }

    /// The simulated times of a run that are asked for, s.
    ///
    /// # Errors
    /// Where none of them is recorded.
    fn stretch_of(&self, record: &WorldRecord) -> Result<[f64; 2]> {
        let Some([from, to]) = self.stretch else { return Ok([f64::NEG_INFINITY, f64::INFINITY]) };
        let (first, last) = (record.start().time_secs(), record.end_secs());
        let recorded = format!("within what is recorded, {first} s to {last} s");
        if !(first..=last).contains(&from) {
            return Err(Error::value("from", from, recorded));
        }
        if !(first..=last).contains(&to) {
            return Err(Error::value("to", to, recorded));
        }
        if to < from {
            return Err(Error::value(
                "to",
                to,
                format!("at or after the {from} s it is to begin at"),
            ));
        }
        Ok([from, to])
    }
}

fn write(order: &DataOrder, run: &Receiver<TakenRun>, reporter: &Reporter) -> Result<String> {
    order.settings.validate("data-every")?;
    let Some(run) = reporter.wait_for(run)? else { return Ok(NOTHING.to_owned()) };
    let record = &run.world.record;
    let stretch = order.stretch_of(record)?;
    let claim = RecordingFolder::of(&order.folder, order.overwrite)?;
    let (first_secs, last_secs) = (record.start().time_secs(), stretch[1].min(record.end_secs()));
    let mut writing = Writing {
        order,
        opened: &run.opened,
        record,
        until_secs: last_secs,
        claim: Some(claim),
        recording: None,
    };
    let mut begun_at = None;
    let ended = record.replay(stretch, |simulation, is_within| {
        let from = *begun_at.get_or_insert(simulation.time_secs().max(first_secs));
        let part = (simulation.time_secs() - from) / (last_secs - from).max(f64::MIN_POSITIVE);
        if reporter.tell(part).is_break() {
            return Ok(ControlFlow::Break(()));
        }
        if is_within {
            writing.take(simulation)?;
        }
        Ok(ControlFlow::Continue(()))
    })?;
    writing.finish(&ended)
}

/// Which grains were pulled by the mouse in which steps.
fn pulls(mut pull: Option<Pull>, first_step: u64, changes: &[&ControlsChange]) -> Vec<String> {
    let mut told = Vec::new();
    let mut since = first_step;
    for change in changes {
        let next = change.controls.pull;
        let grain = |pull: Option<Pull>| pull.map(|pull| pull.grain);
        if grain(next) != grain(pull) {
            if let Some(Pull { grain, .. }) = pull {
                told.push(format!("grain {grain} in steps {since} to {}", change.after_step));
            }
            since = change.after_step + 1;
        }
        pull = next;
    }
    told.extend(pull.map(|Pull { grain, .. }| format!("grain {grain} from step {since} on")));
    told
}

/// What the mouse added, removed and drew, and after which steps.
fn edits(all: &[HandEdit]) -> Vec<String> {
    let told = all.iter().filter_map(|HandEdit { after_step, edit }| {
        let told = match edit {
            Edit::Add(Disc { position, radius }) => {
                format!("a grain of radius {radius} m added at {}, {} m", position.x, position.y)
            }
            Edit::Remove(grain) => format!("grain {grain} removed"),
            Edit::Draw { boundary, to } => {
                format!("boundary {boundary} drawn towards {}, {} m", to.x, to.y)
            }
            Edit::LetGo => return None,
        };
        Some(format!("{told} after step {after_step}"))
    });
    told.collect()
}

/// What is told where an export was given up at once.
const NOTHING: &str = "Stopped before the first frame";

/// A recording that begins with the first moment of its stretch.
struct Writing<'a> {
    order: &'a DataOrder,
    opened: &'a Opened,
    record: &'a WorldRecord,
    until_secs: f64,
    /// The folder, until the recording has it.
    claim: Option<RecordingFolder>,
    recording: Option<Recording>,
}

impl Writing<'_> {
    /// Takes the next moment.
    fn take(&mut self, simulation: &Simulation) -> Result<()> {
        if let Some(claim) = self.claim.take() {
            self.recording = Some(self.start(claim, simulation)?);
        }
        let Some(recording) = &mut self.recording else { return Ok(()) };
        // No step led to the moment that all began with.
        if simulation.observables().step > self.record.start().observables().step {
            recording.add_step(simulation.observables())?;
        }
        match self.order.settings.every_secs {
            Some(_) => recording.add_if_due(simulation),
            None => recording.add(simulation.moment()),
        }
    }

    fn start(&self, claim: RecordingFolder, simulation: &Simulation) -> Result<Recording> {
        let formats = formats_of(&self.order.settings)?;
        let recording = Recording::start_in(claim, &formats, &self.about(simulation)?)?;
        Ok(match self.order.settings.every_secs {
            Some(secs) => recording.at(Times::Every(secs), simulation),
            None => recording,
        })
    }

    /// What is to be known of the recording: the scene with the settings of the first moment, and what was
    /// changed later on.
    fn about(&self, simulation: &Simulation) -> Result<RunFacts> {
        let mut scene = self.opened.scene.clone();
        scene.set_settings(*simulation.settings());
        let step = simulation.observables().step;
        let changes: Vec<_> = self.record.changes(step, self.until_secs).collect();
        let settings = changes
            .iter()
            .map(|change| (change.after_step, change.time_secs, change.controls.settings));
        let mut about = run_facts(&scene, &settings.collect::<Vec<_>>())?;
        let mut tell = |name: &str, said: String| about.facts.push((name.to_owned(), said));
        tell("exported", format!("from the window, from step {step} to {} s", self.until_secs));
        let start = self.record.start().observables();
        if start.step > 0 {
            tell("restarted_from", format!("step {}, {} s", start.step, start.time_secs));
        }
        let pulls = pulls(simulation.pull(), step, &changes);
        if !pulls.is_empty() {
            tell("pulled_by_hand", pulls.join(", "));
        }
        let edits = edits(self.record.edits());
        if !edits.is_empty() {
            tell("changed_by_hand", edits.join(", "));
        }
        Ok(about)
    }

    fn finish(self, ended: &RunEnding) -> Result<String> {
        let Some(recording) = self.recording else { return Ok(NOTHING.to_owned()) };
        let told = recording_sentence(recording.folder(), recording.frames());
        recording.finish()?;
        Ok(match ended {
            RunEnding::Done => told,
            RunEnding::Stopped => format!("Stopped with {told}"),
            RunEnding::NotFinite(_) => {
                format!("{told}, up to the last step with a finite state")
            }
        })
    }
}
