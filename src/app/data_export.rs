//! Export of recordings (files of grains and contacts) of a run that the window has computed. A separate thread
//! computes the run again and writes it, so that neither the window nor the run waits.

use std::ops::ControlFlow;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::notice::Notice;
use super::watched_run::TakenRun;
use super::work::{Reporter, Work};
use crate::config::run_facts;
use crate::data::{
    DEFAULT_FORMAT, DataSettings, FormatName, Recording, RecordingFolder, RunFacts, Times,
    formats_of,
};
use crate::error::{Result, check};
use crate::headless::recording_sentence;
use crate::live::{ControlsChange, HandEdit, WorldRecord};
use crate::number::millis_text;
use crate::sim::{Edit, Pull, RunEnding, Simulation};
use crate::world::Disc;

/// The user's choices for exported recordings (files of the grains and contacts of a run).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct DataChoices {
    /// Folder into which the files of grains and contacts are exported. A relative path starts at the folder of all
    /// exported files.
    pub folder: PathBuf,
    /// Simulated time between two exported states (frames) of the run, s.
    pub every_secs: f64,
    /// True if the state after each step is exported; the interval `every_secs` then has no effect.
    pub each_step: bool,
    /// Formats of the exported files of grains and contacts.
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

/// State of the panel that exports recordings (files of the grains and contacts of a run).
#[derive(Default)]
pub(crate) struct DataPanel {
    /// First and last simulated time of the exported part of the run, s; `None` for the whole run as computed so far.
    pub stretch: Option<[f64; 2]>,
    pub overwrite: bool,
    pub export: Option<Work<String>>,
    pub told: Option<Notice>,
    /// Path of a saved run to be opened, as the user typed it.
    pub saved_run: String,
}

/// A request to export a recording (files of the grains and contacts of a run).
pub(crate) struct DataOrder {
    pub folder: PathBuf,
    pub overwrite: bool,
    /// File formats, and the simulated time between two exported states (frames), s. If this time is `None`, the state
    /// after each step is exported.
    pub settings: DataSettings,
    /// First and last simulated time of the exported part of the run, s; `None` for the whole run as computed so far.
    pub stretch: Option<[f64; 2]>,
}

impl DataOrder {
    /// Computes a run again, writes the files of its grains and contacts, and returns a message for the user. `run` is
    /// a copy of the run's history; it is `None` if the user cancelled before the solver's thread had sent the copy.
    pub(crate) fn write(&self, run: Option<TakenRun>, reporter: &Reporter) -> Result<String> {
        let nothing = || Ok("Stopped before the first frame".to_owned());
        self.settings.validate("data-every")?;
        let Some(run) = run else { return nothing() };
        let record = &run.world.record;
        let stretch = self.stretch_of(record)?;
        // The folder is locked now, but the first file is written later, at the first time of the exported part.
        let mut folder = Some(RecordingFolder::of(&self.folder, self.overwrite)?);
        let mut recording: Option<Recording> = None;
        let start = record.start().observables();
        let last_secs = stretch[1].min(record.end_secs());
        let mut begun_at = None;
        let ended = record.replay(stretch, |simulation, is_within| {
            let now = simulation.time_secs();
            let from = *begun_at.get_or_insert(now.max(start.time_secs));
            let part = (now - from) / (last_secs - from).max(f64::MIN_POSITIVE);
            if reporter.tell(part).is_break() {
                return Ok(ControlFlow::Break(()));
            }
            if let Some(folder) = folder.take_if(|_| is_within) {
                let about = facts(&run, simulation, last_secs)?;
                let started = Recording::start_in(folder, &formats_of(&self.settings)?, &about)?;
                recording = Some(match self.settings.every_secs {
                    Some(secs) => started.at(Times::Every(secs), simulation),
                    None => started,
                });
            }
            let Some(recording) = &mut recording else { return Ok(ControlFlow::Continue(())) };
            // The initial state of a run is not the result of a step, so the table of steps has no row for it.
            if simulation.observables().step > start.step {
                recording.add_step(simulation.observables())?;
            }
            recording.add_if_due(simulation).map(ControlFlow::Continue)
        })?;
        let Some(recording) = recording else { return nothing() };
        let told = recording_sentence(recording.folder(), recording.frames());
        recording.finish()?;
        Ok(match ended {
            RunEnding::Done => told,
            RunEnding::Stopped => format!("Stopped with {told}"),
            RunEnding::NotFinite(_) => format!("{told}, up to the last step with a finite state"),
        })
    }

    /// Returns the first and last simulated time of the exported part of a run, s; −∞ and ∞ if the user chose the whole
    /// run. The error names a time that is outside the run or a last time before the first.
    fn stretch_of(&self, record: &WorldRecord) -> Result<[f64; 2]> {
        let Some([from, to]) = self.stretch else { return Ok([f64::NEG_INFINITY, f64::INFINITY]) };
        let (first, last) = (record.start().time_secs(), record.end_secs());
        let [recorded, found] = [[first, last], [from, to]].map(|times| times.map(millis_text));
        let recorded = format!("within the recording, {} to {}", recorded[0], recorded[1]);
        for (name, secs, found) in [("from", from, &found[0]), ("to", to, &found[1])] {
            check((first..=last).contains(&secs), name, found, &recorded)?;
        }
        let allowed = format!("{}, the beginning, or later", found[0]);
        check(from <= to, "to", &found[1], allowed).map(|()| [from, to])
    }
}

/// Returns the description of a run for its exported files: the scene, its settings, and their later changes. The
/// exported part begins at the present state of `simulation` and ends at the simulated time `until_secs`, s.
fn facts(run: &TakenRun, simulation: &Simulation, until_secs: f64) -> Result<RunFacts> {
    let record = &run.world.record;
    let mut scene = run.start.scene.clone();
    scene.set_settings(*simulation.settings());
    let step = simulation.observables().step;
    let changes: Vec<_> = record.changes(step, until_secs).collect();
    let settings = changes
        .iter()
        .map(|change| (change.after_step, change.time_secs, change.controls.settings));
    let mut about = run_facts(&scene, &settings.collect::<Vec<_>>())?;
    let mut tell = |name: &str, said: String| {
        if !said.is_empty() {
            about.facts.push((name.to_owned(), said));
        }
    };
    tell("exported", format!("from the window, from step {step} to {until_secs} s"));
    let start = record.start().observables();
    if start.step > 0 {
        tell("restarted_from", format!("step {}, {} s", start.step, start.time_secs));
    }
    tell("pulled_by_hand", pulls(simulation.pull(), step, &changes).join(", "));
    tell("changed_by_hand", edits(record.edits()).join(", "));
    Ok(about)
}

/// Returns phrases for the description of a run that state which grains the user pulled with the mouse, and in which
/// steps.
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

/// Returns phrases for the description of a run that state which grains the user added or removed and which walls the
/// user moved, and after which steps.
fn edits(all: &[HandEdit]) -> Vec<String> {
    let told = |HandEdit { after_step, edit }: &HandEdit| {
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
    };
    all.iter().filter_map(told).collect()
}
