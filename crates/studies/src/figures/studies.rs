//! The studies that are shipped with the program, run when a figure needs them, and their rows.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde_json::Value;

use super::claims::{Alike, Claim, Verdict};
use crate::config::Config;
use crate::error::{Error, Result};
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

pub(super) struct StudyRunner {
    folder: PathBuf,
    /// True if studies run their quick pass.
    pub quick: bool,
    pub finished: BTreeMap<&'static str, (Study, RunsTable)>,
}

impl StudyRunner {
    pub(super) fn new(folder: PathBuf, quick: bool) -> Self {
        Self { folder, quick, finished: BTreeMap::new() }
    }

    pub(super) fn run(&mut self, wanted: &str) -> Result<()> {
        let Some(&(name, text)) = STUDIES.iter().find(|(name, _)| *name == wanted) else {
            return Err(Error::value("study", wanted, "one that is shipped"));
        };
        if self.finished.contains_key(name) {
            return Ok(());
        }
        let path = format!("{name}.toml");
        let study = Study::parse(text, path.as_ref(), self.quick)?;
        // Results of an older program's study are of no use here: they are made anew.
        let states = Some(self.folder.join("states"));
        let options = SweepOptions { redo: true, states, shard: None };
        let done = sweep(&study, &self.study_folder(name), &options)?;
        let table = done.ok_or_else(|| Error::value("study", name, "run as a whole"))?;
        self.finished.insert(name, (study, table));
        Ok(())
    }

    /// The rows of a study that was run, but for runs without a finite end: they have no numbers.
    pub(super) fn rows(&self, name: &str) -> Result<Rows<'_>> {
        let found = self.finished.get(name);
        let (_, table) =
            found.ok_or_else(|| Error::value("study", name, "run before its figures"))?;
        let ended = table.rows.iter().filter(|(.., result)| result.status == Status::Done);
        let rows: Vec<_> = ended.map(|(_, config, result)| (config, result)).collect();
        if rows.is_empty() {
            return Err(Error::value(name, "without a run that ended", "run to some finite end"));
        }
        Ok(Rows(rows))
    }

    /// The series of a study's runs, each with its config: its file as text.
    pub(super) fn series(&self, name: &str) -> Result<Vec<(Config, String)>> {
        let Some((study, _)) = self.finished.get(name) else { return Ok(Vec::new()) };
        let read = |run: &PlannedRun| {
            let path = series_path(&self.study_folder(name), &run.key);
            let text = std::fs::read_to_string(&path).map_err(|error| Error::file(&path, error))?;
            Ok((run.config.clone(), text))
        };
        study.runs.iter().map(read).collect()
    }

    /// Says of each claim of a figure how many runs of its studies raised which alarms.
    ///
    /// A verdict is refused from the first run on that lost a grain or had no finite end, whatever the
    /// number of the others: its slump is of another pile, or there is none, and which runs those are
    /// hangs on Bond and Δt, so what is left is no fair sample. Other alarms (deep overlaps, steps that
    /// were not solved as asked) are what a claim about Δt is about, and are counted alone.
    pub(super) fn qualify(&self, studies: &[&str], claims: &mut [Claim]) {
        let tables = studies.iter().filter_map(|name| self.finished.get(name));
        let results: Vec<&RunResult> =
            tables.flat_map(|(_, table)| table.rows.iter().map(|(.., result)| result)).collect();
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
        let pass = if self.quick { "quick" } else { "full" };
        self.folder.join(pass).join(name)
    }

    /// A line for the caption of a figure of some studies, where one of them has run a quick pass.
    pub(super) fn note(&self, studies: &[&str]) -> Option<String> {
        let mut finished = studies.iter().filter_map(|name| self.finished.get(name));
        finished.any(|(study, _)| study.is_quick_pass).then(|| {
            "Quick pass: coarser, fewer initial states; run without --quick for the figure.".into()
        })
    }
}

pub(super) struct Rows<'a>(pub Vec<(&'a Config, &'a RunResult)>);

impl<'a> Rows<'a> {
    pub(super) fn such_that(&self, holds: impl Fn(&Config) -> bool) -> Self {
        Self(self.0.iter().copied().filter(|(config, _)| holds(config)).collect())
    }

    /// Those of initial states that were not chosen for what they show.
    pub(super) fn ensemble(&self) -> Self {
        self.such_that(|config| config.source.seed != Some(NewPile::default().seed))
    }

    pub(super) fn of_bond(&self, bond: f64) -> Self {
        self.such_that(|config| config.parameters.bond == Some(bond))
    }

    pub(super) fn of_step(&self, step: f64) -> Self {
        self.such_that(|config| config.parameters.time_step_secs == Some(step))
    }

    pub(super) fn of_seed(&self, seed: u64) -> Self {
        self.such_that(|config| config.source.seed == Some(seed))
    }

    pub(super) fn of_tolerance(&self, tolerance: f64) -> Self {
        self.such_that(|config| config.solver.tolerance == Some(tolerance))
    }

    pub(super) fn values(&self, number: impl Fn(&Config) -> Option<f64>) -> Vec<f64> {
        let mut values: Vec<f64> = self.0.iter().filter_map(|(config, _)| number(config)).collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        values
    }

    pub(super) fn bonds(&self) -> Vec<f64> {
        self.values(|config| config.parameters.bond)
    }

    pub(super) fn steps(&self) -> Vec<f64> {
        self.values(|config| config.parameters.time_step_secs)
    }

    pub(super) fn tolerances(&self) -> Vec<f64> {
        self.values(|config| config.solver.tolerance)
    }

    pub(super) fn seeds(&self) -> Vec<u64> {
        let mut seeds: Vec<u64> =
            self.0.iter().filter_map(|(config, _)| config.source.seed).collect();
        seeds.sort_unstable();
        seeds.dedup();
        seeds
    }

    pub(super) fn results(&self, number: impl Fn(&RunResult) -> f64) -> Vec<f64> {
        self.0.iter().map(|(_, result)| number(result)).collect()
    }

    pub(super) fn slumps(&self) -> Vec<f64> {
        self.results(|result| result.slump)
    }

    /// Runs by what is said of them, in their order.
    pub(super) fn parts(&self, words: impl Fn(&Config) -> String) -> Vec<(String, Self)> {
        let mut parts: Vec<(String, Self)> = Vec::new();
        for &(config, result) in &self.0 {
            let words = words(config);
            match parts.iter_mut().find(|(known, _)| *known == words) {
                Some((_, part)) => part.0.push((config, result)),
                None => parts.push((words, Self(vec![(config, result)]))),
            }
        }
        parts
    }

    /// Two numbers of each run, rising by the first: a group a state and Bond, the states one after the other.
    pub(super) fn groups(
        &self,
        x: impl Fn(&Config) -> f64,
        y: impl Fn(&RunResult) -> f64,
    ) -> Vec<Alike> {
        let bonds = self.bonds();
        let states = self.seeds().into_iter().map(|seed| self.of_seed(seed));
        let groups = states.flat_map(|state| bonds.iter().map(move |&bond| state.of_bond(bond)));
        let pairs = |group: Rows<'_>| {
            let mut pairs: Alike =
                group.0.iter().map(|(config, result)| (x(config), y(result))).collect();
            pairs.sort_by(|one, other| one.0.total_cmp(&other.0));
            pairs
        };
        groups.map(pairs).collect()
    }
}

/// The settings of a run that are other than those of the first one, but for Bond, Δt and the state.
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

pub(super) fn log_step(config: &Config) -> f64 {
    config.parameters.time_step_secs.unwrap_or(1.0).log10()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::AlarmKind;

    fn result(status: Status, lost_grains: u32, alarm: Option<AlarmKind>) -> RunResult {
        let alarms = alarm.map_or("", AlarmKind::name).to_owned();
        RunResult { status, lost_grains, alarms, ..RunResult::of_slump(0.0) }
    }

    /// A claim that holds, on those runs.
    fn qualified(results: &[&RunResult]) -> Claim {
        let mut studies = StudyRunner::new(PathBuf::new(), true);
        let text = "name = \"pile\"\n[base]\nscene = \"cradle\"\n";
        let study = Study::parse(text, "pile.toml".as_ref(), true).expect("a study");
        let rows = results.iter().map(|&result| (String::new(), Config::default(), result.clone()));
        let table = RunsTable { rows: rows.collect(), wall_secs: vec![0.0; results.len()] };
        studies.finished.insert("pile", (study, table));
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
