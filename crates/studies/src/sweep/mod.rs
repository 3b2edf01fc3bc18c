//! Runs sweeps over parameters. A sweep computes the runs of a study on all cores, stores each result as soon as the
//! run ends, resumes a study that was stopped, and joins parts of a study that were computed on other machines.
//!
//! A folder of results contains `study.json` (name and hash of the study), journals (the results of finished runs),
//! `states/` (initial states), `series/` (a time series of each run), `data/` (recordings of runs) and, once all runs
//! are complete, `runs.csv` and `report.json`.

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

/// Name of the file in a folder of results that says to which study the results belong.
const STUDY_FILE: &str = "study.json";
const DATA: &str = "data";
const STATES: &str = "states";
const TABLE: &str = "runs.csv";
/// Waiting time between two attempts to take over a folder that another process uses.
const MOMENT: Duration = Duration::from_millis(100);
/// Number of attempts to take over a folder that another process uses. The attempts take two seconds together, which is
/// long enough for another process that only reads the folder to finish.
const MOMENTS: u32 = 20;

/// Options of a sweep, which computes the runs of a study.
#[derive(Clone, Debug, Default)]
pub struct SweepOptions {
    /// The part of the study's runs that this call computes, if several machines share the study; `None` for the whole
    /// study.
    pub shard: Option<Shard>,
    /// True to delete results of another study, and results that cannot be read, from the folder. If false, such
    /// results are an error.
    pub redo: bool,
    /// Folder that stores the initial states; `None` for the folder `states` within the folder of results.
    pub states: Option<PathBuf>,
}

#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Label {
    study: String,
    fingerprint: String,
    runs: usize,
    version: String,
}

/// Computes the runs of a study, or a part of the runs, and stores the results in `folder`. After the whole study,
/// writes `runs.csv` and returns its table; after a part, returns `None`.
///
/// # Errors
/// If the folder contains another study or cannot be written, or if the grains of an initial state do not come to rest.
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
    // Finished runs that do not belong to this part are ignored.
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
    // All runs are complete, so no other process is still writing files here.
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

/// Joins the results of a study's parts, which are in `folders`, into one table, and writes it as `runs.csv` to the
/// folder `out`.
///
/// # Errors
/// If a folder contains another study, if runs are missing, or if two parts have different results for a run.
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

/// Starts the recording of a run (its grains over time, in files), if the study file asks for recordings. An incomplete
/// recording from an earlier attempt, which was stopped, is removed.
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

/// Assigns the folder of results to this study, or checks that the folder already belongs to this study.
///
/// The file `study.json` says to which study the folder belongs. If the program is killed before it has written this
/// file, the folder still belongs to the old study and lacks only the old table, which can be recomputed from the
/// journals. If the program is killed later, the folder belongs to the new study. The remaining files of the old study
/// do no harm, because runs are identified by keys, and are removed.
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
        // A process that runs another part of the same study may have assigned the folder in the meantime.
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

/// Removes the results of a study from a folder. No other process may write results to the folder at the same time.
/// Files that this program did not write remain.
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
        // A folder that is not empty cannot be removed, and remains.
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
