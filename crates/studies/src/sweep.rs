//! The sweep engine: runs a study on all cores, keeps each result as it comes, goes on where it
//! stopped, and joins parts that ran elsewhere.
//!
//! A folder of results holds `study.json` (which study it is), journals (results as they come),
//! `states/` (initial states), `series/` (courses of runs), `data/` (recordings of runs) and, once all runs
//! are there, `runs.csv`.

use std::io::ErrorKind::NotFound;
use std::path::{Path, PathBuf};
use std::time::Instant;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::course::{self, Course};
use super::journal::{self, Entry, Journal};
use super::outcome::run_to_end;
use super::states::States;
use super::table::RunsTable;
use super::{PlannedRun, Shard, Study};
use crate::config::scene_facts;
use crate::data::{Recording, Times, formats_of};
use crate::error::{Error, Result};
use crate::output::{
    Progress, check_writable, note_line, remove_folder_if_there, remove_if_there, write_file,
};
use crate::scene::Scene;

/// File that says which study a folder holds.
const STUDY_FILE: &str = "study.json";
/// Folder of the runs' recordings.
const DATA: &str = "data";
/// The table of a finished study.
const TABLE: &str = "runs.csv";
/// Lines that tell of progress where there is no terminal to draw a bar on.
const LINES_OF_PROGRESS: usize = 20;

/// How a sweep is to run.
#[derive(Clone, Debug, Default)]
pub struct SweepOptions {
    /// The part of the study to run; all of it where there is none.
    pub shard: Option<Shard>,
    /// Throw away what a folder holds of another study, or what cannot be read.
    pub redo: bool,
    /// Where initial states are kept; in the folder of results where nothing is said.
    pub states: Option<PathBuf>,
}

/// What `study.json` says.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Label {
    study: String,
    fingerprint: String,
    runs: usize,
    version: String,
}

/// Runs a study, or a part of it, into `folder`. Where that completes the study, `runs.csv` is
/// written and given back.
///
/// # Errors
/// Where the folder holds another study or cannot be written, or a state does not settle.
pub fn sweep(study: &Study, folder: &Path, options: &SweepOptions) -> Result<Option<RunsTable>> {
    check_writable("out", folder)?;
    claim(study, folder, options.redo)?;
    let journal_name = match options.shard {
        Some(Shard { index, count }) => format!("runs-{index}-of-{count}"),
        None => "runs".to_owned(),
    };
    let folders = [folder.to_owned()];
    let open = || -> Result<_> {
        let journal = Journal::open(folder, &journal_name)?;
        Ok((journal, journal::read_all(&folders)?))
    };
    let (journal, mut done) = match open() {
        Err(error) if options.redo => {
            note_line(format_args!("{error}; thrown away"));
            throw_away(folder)?;
            open()?
        }
        opened => opened?,
    };
    if study.data.is_some() {
        done.retain(|key, _| data_path(folder, key).exists());
    }

    let mine = |index: usize| options.shard.is_none_or(|shard| shard.has(index));
    let mut part: Vec<&PlannedRun> = study
        .runs
        .iter()
        .enumerate()
        .filter(|(index, _)| mine(*index))
        .map(|(_, run)| run)
        .collect();
    let of_part = part.len();
    let is_whole = |entry| study.series.is_none() || course::is_whole(folder, entry);
    part.retain(|run| !done.get(&run.key).is_some_and(is_whole));
    if part.len() < of_part {
        note_line(format_args!(
            "{}: {} of {of_part} runs were there",
            study.name,
            of_part - part.len()
        ));
    }
    // Longest first, so that no core waits long for the last one. The sort is stable.
    part.sort_by(|one, other| other.cost.total_cmp(&one.cost));
    let states_folder = options.states.clone().unwrap_or_else(|| folder.join("states"));
    let states = States::of(states_folder, part.iter().map(|run| &run.config))?;
    run_all(study, folder, &journal, &states, part)?;
    if options.shard.is_some() {
        return Ok(None);
    }
    join(study, &folders, folder).map(Some)
}

/// Joins the parts that lie in `folders` into `runs.csv` in `out`.
///
/// # Errors
/// Where a folder holds another study, runs are missing, or two parts disagree.
pub fn merge(study: &Study, folders: &[PathBuf], out: &Path) -> Result<RunsTable> {
    for folder in folders {
        match read_label(folder)? {
            Some(label) if label == label_of(study) => {}
            Some(label) => return Err(other_study(folder, study, &label)),
            None => {
                return Err(Error::file(
                    folder.join(STUDY_FILE),
                    "No such file: no sweep began here",
                ));
            }
        }
    }
    check_writable("out", out)?;
    join(study, folders, out)
}

fn join(study: &Study, folders: &[PathBuf], out: &Path) -> Result<RunsTable> {
    let table = RunsTable::new(study, &journal::read_all(folders)?)?;
    table.write(&out.join(TABLE))?;
    Ok(table)
}

fn run_all(
    study: &Study,
    folder: &Path,
    journal: &Journal,
    states: &States,
    part: Vec<&PlannedRun>,
) -> Result<()> {
    let total = part.len();
    let cost = |run: &PlannedRun| run.cost.ceil() as u64;
    let progress = Progress::new(&study.name, part.iter().map(|run| cost(run)).sum());
    let finished = std::sync::atomic::AtomicUsize::new(0);
    let ended = part.into_iter().par_bridge().try_for_each(|run| {
        let started = Instant::now();
        let scene = states.scene(&run.config)?;
        let mut course = Course::start(study.series.as_ref());
        let mut recording = recording_of(study, folder, run, &scene)?;
        let row = |simulation: &_| course.add(simulation);
        let outcome = run_to_end(&scene, study.series.as_ref(), row, recording.as_mut())?;
        let course = course.finish(folder, &run.key)?;
        recording.map_or(Ok(()), Recording::finish)?;
        let wall_secs = started.elapsed().as_secs_f64();
        journal.add(&Entry { key: run.key.clone(), wall_secs, outcome, course })?;
        progress.advance(cost(run));
        let count = 1 + finished.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        if !progress.is_drawn()
            && count * LINES_OF_PROGRESS / total > (count - 1) * LINES_OF_PROGRESS / total
        {
            progress.say(&format!("{}: {count} of {total} runs", study.name));
        }
        Ok(())
    });
    progress.finish();
    ended
}

/// The recording of one run, where the study asks for it. What a run that was stopped has left of one is
/// removed.
fn recording_of(
    study: &Study,
    folder: &Path,
    run: &PlannedRun,
    scene: &Scene,
) -> Result<Option<Recording>> {
    let Some(data) = &study.data else { return Ok(None) };
    let path = data_path(folder, &run.key);
    let recording = Recording::start(&path, &formats_of(data)?, &scene_facts(scene)?, true)?;
    Ok(Some(recording.at(Times::of(data), &scene.simulation()?)))
}

/// Where the recording of the run with a key lies.
fn data_path(folder: &Path, key: &str) -> PathBuf {
    folder.join(DATA).join(key)
}

fn label_of(study: &Study) -> Label {
    Label {
        study: study.name.clone(),
        fingerprint: study.fingerprint.clone(),
        runs: study.runs.len(),
        version: env!("CARGO_PKG_VERSION").into(),
    }
}

fn read_label(folder: &Path) -> Result<Option<Label>> {
    let path = folder.join(STUDY_FILE);
    match std::fs::read(&path) {
        Ok(bytes) => {
            serde_json::from_slice(&bytes).map(Some).map_err(|error| Error::file(&path, error))
        }
        Err(error) if error.kind() == NotFound => Ok(None),
        Err(error) => Err(Error::file(&path, error)),
    }
}

/// Makes the folder that of this study, or finds that it is.
///
/// The label is what makes it one study's. Before it is written the folder is the old study's without
/// its table, which comes again from the journals; after it, the new study's. What is left of the old
/// one then counts for nothing, as runs are known by their keys, and is swept out.
fn claim(study: &Study, folder: &Path, redo: bool) -> Result<()> {
    let label = label_of(study);
    let anew = match read_label(folder) {
        Ok(Some(found)) if found == label => return Ok(()),
        Ok(Some(found)) if !redo => return Err(other_study(folder, study, &found)),
        Err(error) if !redo => return Err(error),
        Ok(Some(_)) | Err(_) => true,
        Ok(None) => false,
    };
    if anew {
        remove_if_there(&folder.join(TABLE))?;
    }
    let path = folder.join(STUDY_FILE);
    let mut text =
        serde_json::to_string_pretty(&label).map_err(|error| Error::file(&path, error))?;
    text.push('\n');
    write_file(&path, text.as_bytes())?;
    if anew { throw_away(folder) } else { Ok(()) }
}

/// Sweeps out a folder's results, but for those that other programs are writing.
fn throw_away(folder: &Path) -> Result<()> {
    remove_if_there(&folder.join(TABLE))?;
    journal::remove_all(folder)?;
    course::remove_all(folder)?;
    remove_folder_if_there(&folder.join(DATA))
}

fn other_study(folder: &Path, study: &Study, found: &Label) -> Error {
    let reason = format!(
        "holds {} runs of study {} ({}), but must be empty or hold study {} ({}); --redo throws \
         them away",
        found.runs, found.study, found.fingerprint, study.name, study.fingerprint
    );
    Error::file(folder, reason)
}
