//! Runs those studies (sets of runs) on which figures are based. The study files are part of the program.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde_json::Value;

use super::claims::{Alike, Claim, Verdict};
use crate::config::Config;
use crate::error::{Error, Result};
use crate::harness::{Effort, MeasuredCase, Measurements, RunReadings, named};
use crate::scene::NewPile;
use crate::sweep::alarms_of;
use crate::{PlannedRun, RunResult, RunsTable, Status, Study, SweepOptions, series_path, sweep};

macro_rules! shipped {
    ($($name:literal)*) => {
        &[$(($name, include_str!(concat!("../../../../assets/studies/", $name, ".toml")))),*]
    };
}

const STUDIES: &[(&str, &str)] = shipped![
    "pile" "pile-compressive" "cradle-courses" "cradle-choices" "cradle-share" "cradle-map" "pile-map"
];

/// A study (a set of runs) after all its runs have been computed.
pub(super) struct FinishedStudy {
    study: Study,
    pub table: RunsTable,
    /// Runs that reached their end. The other runs ended early, with NaN or infinite positions or velocities.
    ended: Vec<MeasuredCase>,
}

impl FinishedStudy {
    fn new(study: Study, table: RunsTable) -> Self {
        let ended = table.rows.iter().filter(|(.., result)| result.status == Status::Done);
        let ended = ended.map(|(_, config, result)| measured(config, result)).collect();
        Self { study, table, ended }
    }
}

/// Returns the parameters and the measured numbers of a run, each with its name.
fn measured(config: &Config, result: &RunResult) -> MeasuredCase {
    let Config { source, parameters, solver, .. } = config;
    let at = [
        ("bond", parameters.bond),
        ("dt", parameters.time_step_secs),
        ("tolerance", solver.tolerance),
        ("start", source.start),
        ("seed", source.seed.map(|seed| seed as f64)),
    ];
    let at = at.into_iter().filter_map(|(name, number)| Some((name, number?))).collect();
    let readings = named([
        ("slump", result.slump),
        ("mean_overlap", result.tally.mean_overlap),
        ("mean_contacts", result.tally.mean_contacts),
        ("first_gap", result.first_gap),
    ]);
    MeasuredCase { at, run: RunReadings { readings, ..RunReadings::default() }, wall_secs: 0.0 }
}

/// Returns the runs from all initial states except the state that is shipped with the program, which was chosen for
/// illustration and is not a random sample.
pub(super) fn ensemble<'a>(runs: &Measurements<'a>) -> Measurements<'a> {
    runs.such_that(|run| run.at("seed") != NewPile::default().seed as f64)
}

/// Returns one group of runs per initial state and Bond number, with the two numbers (x, y) of each run, sorted by x.
/// `x` and `y` compute the numbers. Groups with the same initial state follow each other.
pub(super) fn groups(
    runs: &Measurements<'_>,
    x: impl Fn(&MeasuredCase) -> f64,
    y: impl Fn(&MeasuredCase) -> f64,
) -> Vec<Alike> {
    let bonds = runs.values("bond");
    let states = runs.by_seed(|state| {
        let of_bond = |&bond: &f64| state.with("bond", bond).rising(|run| (x(run), y(run)));
        bonds.iter().map(of_bond).collect::<Vec<_>>()
    });
    states.concat()
}

pub(super) fn log_step(run: &MeasuredCase) -> f64 {
    run.at("dt").log10()
}

pub(super) struct StudyRunner {
    folder: PathBuf,
    effort: Effort,
    pub finished: BTreeMap<&'static str, FinishedStudy>,
}

impl StudyRunner {
    pub(super) fn new(folder: PathBuf, effort: Effort) -> Self {
        Self { folder, effort, finished: BTreeMap::new() }
    }

    pub(super) fn run(&mut self, wanted: &str) -> Result<()> {
        let Some(&(name, text)) = STUDIES.iter().find(|(name, _)| *name == wanted) else {
            return Err(Error::value("study", wanted, "one that is shipped"));
        };
        if self.finished.contains_key(name) {
            return Ok(());
        }
        let path = format!("{name}.toml");
        let study = Study::parse(text, path.as_ref(), self.effort == Effort::Quick)?;
        // `redo` discards results of a study by an older version of the program.
        let states = Some(self.folder.join("states"));
        let options = SweepOptions { redo: true, states, shard: None };
        let done = sweep(&study, &self.study_folder(name), &options)?;
        let table = done.ok_or_else(|| Error::value("study", name, "run as a whole"))?;
        self.finished.insert(name, FinishedStudy::new(study, table));
        Ok(())
    }

    /// Returns the runs of a study that reached their end with finite positions and velocities.
    pub(super) fn rows(&self, name: &str) -> Result<Measurements<'_>> {
        let found = self.finished.get(name);
        let found = found.ok_or_else(|| Error::value("study", name, "run before its figures"))?;
        if found.ended.is_empty() {
            return Err(Error::value(name, "without a run that ended", "run to some finite end"));
        }
        Ok(Measurements(found.ended.iter().collect()))
    }

    /// Returns the runs of a study that reached their end, grouped by the settings in which they differ from the first
    /// run (except Bond number, Δt and initial state). Each group has a name that lists these settings. The groups are
    /// in the order of the runs.
    pub(super) fn choices(&self, name: &str) -> Result<Vec<(String, Measurements<'_>)>> {
        let rows = self.rows(name)?;
        let table = self.finished[name].table.rows.iter();
        let configs: Vec<&Config> = table
            .filter(|(.., result)| result.status == Status::Done)
            .map(|(_, config, _)| config)
            .collect();
        let mut parts: Vec<(String, Measurements<'_>)> = Vec::new();
        for (&config, run) in configs.iter().zip(rows.0) {
            let words = changes(config, configs[0]);
            match parts.iter_mut().find(|(known, _)| *known == words) {
                Some((_, part)) => part.0.push(run),
                None => parts.push((words, Measurements(vec![run]))),
            }
        }
        Ok(parts)
    }

    /// Returns the settings of each run of a study, and the text of the CSV file with the time series of the run.
    pub(super) fn series(&self, name: &str) -> Result<Vec<(Config, String)>> {
        let Some(FinishedStudy { study, .. }) = self.finished.get(name) else {
            return Ok(Vec::new());
        };
        let read = |run: &PlannedRun| {
            let path = series_path(&self.study_folder(name), &run.key);
            let text = std::fs::read_to_string(&path).map_err(|error| Error::file(&path, error))?;
            Ok((run.config.clone(), text))
        };
        study.runs.iter().map(read).collect()
    }

    /// Adds warnings to the tested statements (claims) of a figure: each statement gets the number of runs in the
    /// figure's studies that raised warnings, for each kind of warning.
    ///
    /// If a grain left the scene in a single run, or if a run did not reach its end, the verdict becomes open, however
    /// many other runs there are. The slump of such a run is missing or belongs to a different pile. Such failures
    /// depend on the Bond number and on Δt, so the remaining runs are not a fair sample. Other warnings (deep overlaps,
    /// unsolved steps) are among the effects of Δt that are tested, so they are only counted.
    pub(super) fn qualify(&self, studies: &[&str], claims: &mut [Claim]) {
        let tables = studies.iter().filter_map(|name| self.finished.get(name));
        let results: Vec<&RunResult> =
            tables.flat_map(|one| one.table.rows.iter().map(|(.., result)| result)).collect();
        let Some(alarms) = alarms_of(results.iter().copied()) else { return };
        let is_spoilt =
            |result: &&&RunResult| result.status != Status::Done || result.lost_grains > 0;
        let spoilt = results.iter().filter(is_spoilt).count();
        for claim in claims {
            claim.measured = format!("{}; {alarms}", claim.measured);
            if spoilt > 0 {
                claim.measured =
                    format!("{}, and {spoilt} lost grains or did not end", claim.measured);
                claim.verdict = Verdict::Open;
            }
        }
    }

    fn study_folder(&self, name: &str) -> PathBuf {
        self.folder.join(self.effort.name()).join(name)
    }

    /// Returns a line for the caption of a figure, which says that a study of the figure was a quick pass, with fewer
    /// runs; `None` if all studies were full passes.
    pub(super) fn note(&self, studies: &[&str]) -> Option<String> {
        let mut finished = studies.iter().filter_map(|name| self.finished.get(name));
        finished.any(|one| one.study.is_quick_pass).then(|| {
            "Quick pass: coarser, fewer initial states; run without --quick for the figure.".into()
        })
    }
}

/// Returns a list, as text, of the settings in which a run differs from the first run, without Bond number, Δt and
/// initial state.
pub(super) fn changes(config: &Config, first: &Config) -> String {
    let settings = |config: &Config| serde_json::to_value(config).unwrap_or_default();
    let (here, first) = (settings(config), settings(first));
    let is_change = |(name, value): &(&String, &Value)| {
        !["bond", "dt", "seed"].contains(&name.as_str()) && first.get(*name) != Some(*value)
    };
    let all = here.as_object().into_iter().flatten().filter(is_change);
    let words = |(name, value): (&String, &Value)| format!("{name} {value}").replace('"', "");
    let changes: Vec<String> = all.map(words).collect();
    if changes.is_empty() { "as it is".to_owned() } else { changes.join(", ") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::AlarmKind;

    fn result(status: Status, lost_grains: u32, alarm: Option<AlarmKind>) -> RunResult {
        let alarms = alarm.map_or("", AlarmKind::name).to_owned();
        RunResult { status, lost_grains, alarms, ..RunResult::of_slump(0.0) }
    }

    /// Returns, for tests, a claim (a tested statement) with the verdict "holds", after [`StudyRunner::qualify`] has
    /// added the warnings of the runs `results`. If grains left the scene in one of these runs, or one of them did not
    /// reach its end, the verdict has become open.
    fn qualified(results: &[&RunResult]) -> Claim {
        let mut studies = StudyRunner::new(PathBuf::new(), Effort::Quick);
        let text = "name = \"pile\"\n[base]\nscene = \"cradle\"\n";
        let study = Study::parse(text, "pile.toml".as_ref(), true).expect("a study");
        let rows = results.iter().map(|&result| (String::new(), Config::default(), result.clone()));
        let table = RunsTable { rows: rows.collect(), wall_secs: vec![0.0; results.len()] };
        studies.finished.insert("pile", FinishedStudy::new(study, table));
        let mut claims = [Claim::new("it falls", "p = 0.001", Verdict::Holds)];
        studies.qualify(&["pile"], &mut claims);
        let [claim] = claims;
        claim
    }

    #[test]
    fn one_run_that_lost_a_grain_or_did_not_end_refuses_the_verdict_and_other_alarms_are_counted() {
        let sound = result(Status::Done, 0, None);
        let deep = result(Status::Done, 0, Some(AlarmKind::Overlap));
        let lost = result(Status::Done, 2, Some(AlarmKind::GrainLost));
        let infinite = result(Status::NotFinite, 0, Some(AlarmKind::NotFinite));

        let claim = qualified(&[&sound; 40]);
        assert_eq!((claim.measured.as_str(), claim.verdict), ("p = 0.001", Verdict::Holds));
        let claim = qualified(&[&sound, &deep, &sound]);
        assert_eq!(claim.measured, "p = 0.001; 1 of 3 runs raised alarms (overlap 1)");
        assert_eq!(claim.verdict, Verdict::Holds);
        for spoilt in [&lost, &infinite] {
            let mut results = vec![&sound; 999];
            results.extend([&deep, spoilt]);
            let claim = qualified(&results);
            assert!(claim.measured.starts_with("p = 0.001; 2 of 1001 runs raised"));
            assert!(claim.measured.ends_with(", and 1 lost grains or did not end"));
            assert_eq!(claim.verdict, Verdict::Open);
        }
    }
}
