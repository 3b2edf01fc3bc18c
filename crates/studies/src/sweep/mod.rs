//! The sweep engine: runs a study on all cores, keeps each result as it comes, goes on where it
//! stopped, and joins parts that ran elsewhere.
//!
//! A folder of results holds `study.json` (which study it is), journals (results as they come), `states/` (initial
//! states), `series/` (rows of each run over time), `data/` (recordings of runs) and, once all runs are there,
//! `runs.csv` and `report.json`.

mod drawing;
mod drawing_choice;
mod groups;
mod plan;
mod ranges;
mod results;
mod run_group;
mod series;

use std::collections::HashSet;
use std::io::ErrorKind::NotFound;
use std::path::{Path, PathBuf};
use std::time::Duration;

use serde::{Deserialize, Serialize};

pub use self::drawing_choice::SweepChart;
use self::groups::REPORT;
pub use self::groups::write_means;
pub use self::plan::{PlannedRun, SeriesSettings, Study};
pub(crate) use self::results::alarms_of;
pub use self::results::{RunResult, RunsTable, Status};
use self::results::{SweptRun, run_to_end};
pub use self::series::series_path;
use self::series::{SERIES, Series};
use crate::config::scene_facts;
use crate::data::{Recording, Times, formats_of, remove_recording};
use crate::error::{Error, Result};
use crate::harness::{Case, Journal, Runner, Shard, Threads, journal};
use crate::output::{
    SharedFolder, check_recognised, check_writable, is_recognised, note_line, remove_drafts,
    remove_if_there, write_file,
};
use crate::scene::Scene;
use crate::states::States;

/// File that says which study a folder holds.
const STUDY_FILE: &str = "study.json";
const DATA: &str = "data";
const STATES: &str = "states";
const TABLE: &str = "runs.csv";
/// How long, and how often, another part that only looks at the folder is waited for.
const MOMENT: Duration = Duration::from_millis(100);
const MOMENTS: u32 = 20;

/// How a sweep is to run.
#[derive(Clone, Debug, Default)]
pub struct SweepOptions {
    /// The part of the study to run; all of it where there is none.
    pub shard: Option<Shard>,
    /// Throw away what a folder holds of another study, or what cannot be read.
    pub redo: bool,
    /// The folder of initial states; one in the folder of results where there is none.
    pub states: Option<PathBuf>,
}

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
    let shared = SharedFolder::of(folder)?;
    let journal_name = options.shard.map_or_else(|| "runs".to_owned(), |it| it.journal("runs"));
    let journal_path = journal::path_of(folder, &journal_name);
    claim(study, folder, options.redo, &shared, &journal_path)?;
    let folders = [folder.to_owned()];
    let open = || -> Result<_> {
        let journal = Journal::open(folder, &journal_name)?;
        Ok((journal, journal::read_all::<SweptRun>(&folders)?))
    };
    let (journal, mut finished) = match open() {
        Err(error) if options.redo => {
            let thrown_away = shared.alone(|| {
                check_recognised(&journal_path, "redo")?;
                throw_away(folder)
            })?;
            thrown_away.ok_or_else(|| shared.in_use())?;
            note_line(format_args!("{error}; thrown away"));
            open()?
        }
        opened => opened?,
    };
    let mine = |index: usize| options.shard.is_none_or(|shard| shard.has(index));
    let part = study.runs.iter().enumerate().filter(|(index, _)| mine(*index));
    let cases: Vec<Case<&PlannedRun>> =
        part.map(|(_, run)| Case { key: run.key.clone(), cost: run.cost, setup: run }).collect();
    // Files of runs that are no part of this are none of its business.
    let keys: HashSet<&str> = cases.iter().map(|case| case.key.as_str()).collect();
    finished.retain(|key, case| {
        keys.contains(key.as_str())
            && (study.data.is_none() || data_path(folder, key).exists())
            && (study.series.is_none()
                || series::is_whole(folder, key, case.result.series.as_deref()))
    });
    if !finished.is_empty() {
        let (done, all) = (finished.len(), cases.len());
        note_line(format_args!("{}: {done} of {all} runs were there", study.name));
    }
    let states_folder = options.states.clone().unwrap_or_else(|| folder.join(STATES));
    let pending = cases.iter().filter(|case| !finished.contains_key(&case.key));
    let states = States::of(states_folder, pending.map(|case| &case.setup.config))?;
    let runner = Runner::new(&study.name, journal, finished);
    runner.run(&cases, Threads::All, |run| swept(study, folder, &states, run))?;
    if options.shard.is_some() {
        return Ok(None);
    }
    let table = join(study, &folders, folder)?;
    // All runs are there, so no other process is writing one.
    let drafts = [folder.to_owned(), folder.join(SERIES), folder.join(STATES)];
    drafts.iter().try_for_each(|folder| remove_drafts(folder))?;
    Ok(Some(table))
}

fn swept(study: &Study, folder: &Path, states: &States, run: &PlannedRun) -> Result<SweptRun> {
    let scene = states.scene(&run.config)?;
    let mut series = study.series.as_ref().map(|settings| Series::start(settings, &scene));
    let mut recording = recording_of(study, folder, run, &scene)?;
    let outcome = run_to_end(&scene, series.as_mut(), recording.as_mut())?;
    let series = series.map(|series| series.finish(folder, &run.key)).transpose()?;
    recording.map_or(Ok(()), Recording::finish)?;
    Ok(SweptRun { outcome, series })
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
fn claim(
    study: &Study,
    folder: &Path,
    redo: bool,
    shared: &SharedFolder,
    journal: &Path,
) -> Result<()> {
    let label = label_of(study);
    let begin = || {
        let path = folder.join(STUDY_FILE);
        let text = serde_json::to_string_pretty(&label);
        let text = text.map_err(|error| Error::file(&path, error))?;
        write_file(&path, format!("{text}\n").as_bytes())
    };
    let begin_anew = || {
        for path in [&folder.join(TABLE), &folder.join(STUDY_FILE), journal] {
            if path.is_file() {
                check_recognised(path, "redo")?;
            }
        }
        remove_if_there(&folder.join(TABLE))?;
        begin()?;
        throw_away(folder)
    };
    for _ in 0..MOMENTS {
        // Another part of the same study may have begun anew.
        match read_label(folder) {
            Ok(Some(found)) if found == label => return Ok(()),
            Ok(Some(found)) if !redo => return Err(other_study(folder, study, &found)),
            Err(error) if !redo => return Err(error),
            Ok(None) => return begin(),
            Ok(Some(_)) | Err(_) => {}
        }
        if shared.alone(begin_anew)?.is_some() {
            return Ok(());
        }
        std::thread::sleep(MOMENT);
    }
    Err(shared.in_use())
}

/// Sweeps out a folder's results, which no other program may be writing. What this program did not write stays.
fn throw_away(folder: &Path) -> Result<()> {
    let of_series = journal::files_in(&folder.join(SERIES))?;
    let tables = [TABLE, REPORT].map(|name| folder.join(name));
    for path in journal::free_journals(folder)?.into_iter().chain(tables).chain(of_series) {
        if path.is_file() && is_recognised(&path)? {
            remove_if_there(&path)?;
        }
    }
    for path in journal::files_in(&folder.join(DATA))?.iter().filter(|path| path.is_dir()) {
        remove_recording(path)?;
    }
    for inner in [SERIES, DATA] {
        // One that is not empty stays.
        let _ = std::fs::remove_dir(folder.join(inner));
    }
    Ok(())
}

fn other_study(folder: &Path, study: &Study, found: &Label) -> Error {
    let reason = format!(
        "holds {} runs of study {} ({}), but must be empty or hold study {} ({}); --redo throws \
         them away",
        found.runs, found.study, found.fingerprint, study.name, study.fingerprint
    );
    Error::file(folder, reason)
}
