//! Where figures are made: the studies that are shipped with the program, run when a figure needs
//! them, and their rows.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::verdict::{Claim, Verdict};
use crate::config::Config;
use crate::error::{Error, Result};
use crate::scene::NewPile;
use crate::table::alarms_of;
use crate::{Outcome, RunsTable, Status, Study, SweepOptions, series_path, sweep};

/// The studies that are shipped.
const STUDIES: [(&str, &str); 18] = [
    ("pile", include_str!("../../../../assets/studies/pile.toml")),
    ("pile-compressive", include_str!("../../../../assets/studies/pile-compressive.toml")),
    ("pile-choices", include_str!("../../../../assets/studies/pile-choices.toml")),
    ("cradle", include_str!("../../../../assets/studies/cradle.toml")),
    ("cradle-courses", include_str!("../../../../assets/studies/cradle-courses.toml")),
    ("cradle-choices", include_str!("../../../../assets/studies/cradle-choices.toml")),
    ("cradle-share", include_str!("../../../../assets/studies/cradle-share.toml")),
    ("cradle-map", include_str!("../../../../assets/studies/cradle-map.toml")),
    ("pile-map", include_str!("../../../../assets/studies/pile-map.toml")),
    ("pile-size", include_str!("../../../../assets/studies/pile-size.toml")),
    ("pile-tolerance", include_str!("../../../../assets/studies/pile-tolerance.toml")),
    ("range", include_str!("../../../../assets/studies/range.toml")),
    ("range-regimes", include_str!("../../../../assets/studies/range-regimes.toml")),
    ("range-size", include_str!("../../../../assets/studies/range-size.toml")),
    ("dry", include_str!("../../../../assets/studies/dry.toml")),
    ("cohesion", include_str!("../../../../assets/studies/cohesion.toml")),
    ("friction", include_str!("../../../../assets/studies/friction.toml")),
    ("tolerance", include_str!("../../../../assets/studies/tolerance.toml")),
];

/// Finished studies by name.
pub(super) struct Workshop {
    folder: PathBuf,
    /// Whether studies run their quick pass.
    pub quick: bool,
    /// Studies and their results.
    pub finished: BTreeMap<&'static str, (Study, RunsTable)>,
}

impl Workshop {
    /// A workshop that keeps its studies in `folder`.
    pub(super) fn new(folder: PathBuf, quick: bool) -> Self {
        Self { folder, quick, finished: BTreeMap::new() }
    }

    /// Runs a shipped study, unless it was run before.
    ///
    /// # Errors
    /// As [`sweep`].
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

    /// The results of a study that was run, but for runs without a finite end: they have no numbers.
    pub(super) fn rows(&self, name: &str) -> Result<Rows<'_>> {
        let found = self.finished.get(name);
        let (_, table) =
            found.ok_or_else(|| Error::value("study", name, "run before its figures"))?;
        let ended = table.rows.iter().filter(|(.., outcome)| outcome.status == Status::Done);
        let rows: Vec<_> = ended.map(|(_, config, outcome)| (config, outcome)).collect();
        if rows.is_empty() {
            return Err(Error::value(name, "without a run that ended", "run to some finite end"));
        }
        Ok(Rows(rows))
    }

    /// The courses of a study's runs, each with its config: its file as text.
    pub(super) fn courses(&self, name: &str) -> Result<Vec<(Config, String)>> {
        let Some((study, _)) = self.finished.get(name) else { return Ok(Vec::new()) };
        let read = |run: &crate::PlannedRun| {
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
        let of_studies = studies.iter().filter_map(|name| self.finished.get(name));
        let outcomes = || {
            let tables = of_studies.clone().map(|(_, table)| table);
            tables.flat_map(|table| table.rows.iter().map(|(.., outcome)| outcome))
        };
        let Some(told) = alarms_of(outcomes()) else { return };
        let spoilt = |outcome: &&Outcome| outcome.status != Status::Done || outcome.lost_grains > 0;
        let spoilt = outcomes().filter(spoilt).count();
        for claim in claims {
            claim.measured = format!("{}; {told}", claim.measured);
            if spoilt > 0 {
                claim.measured =
                    format!("{}, and {spoilt} lost grains or did not end", claim.measured);
                claim.verdict = Verdict::Open;
            }
        }
    }

    fn study_folder(&self, name: &str) -> PathBuf {
        let pass = if self.quick { "quick" } else { "full" };
        self.folder.join(Path::new(pass)).join(name)
    }

    /// A line for the caption where the pass is quick.
    pub(super) fn note(&self) -> Vec<String> {
        if self.quick {
            vec![
                "Quick pass: coarser, fewer initial states; run without --quick for the figure."
                    .into(),
            ]
        } else {
            Vec::new()
        }
    }
}

/// Runs and what came of them.
pub(super) struct Rows<'a>(pub Vec<(&'a Config, &'a Outcome)>);

impl<'a> Rows<'a> {
    /// Those that a condition picks.
    pub(super) fn such_that(&self, holds: impl Fn(&Config) -> bool) -> Self {
        Self(self.0.iter().copied().filter(|(config, _)| holds(config)).collect())
    }

    /// Those of initial states that were not chosen for what they show.
    pub(super) fn ensemble(&self) -> Self {
        self.such_that(|config| config.source.seed != Some(NewPile::default().seed))
    }

    /// The different values of a number, rising.
    pub(super) fn values(&self, number: impl Fn(&Config) -> Option<f64>) -> Vec<f64> {
        let mut values: Vec<f64> = self.0.iter().filter_map(|(config, _)| number(config)).collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        values
    }

    /// An outcome of all runs.
    pub(super) fn outcomes(&self, number: impl Fn(&Outcome) -> f64) -> Vec<f64> {
        self.0.iter().map(|(_, outcome)| number(outcome)).collect()
    }

    /// Seeds that are there, rising.
    pub(super) fn seeds(&self) -> Vec<u64> {
        let mut seeds: Vec<u64> =
            self.0.iter().filter_map(|(config, _)| config.source.seed).collect();
        seeds.sort_unstable();
        seeds.dedup();
        seeds
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::AlarmKind;

    fn outcome(status: Status, lost_grains: u32, alarm: Option<AlarmKind>) -> Outcome {
        let alarms = alarm.into_iter().collect();
        Outcome { status, lost_grains, alarms, ..Outcome::of_slump(0.0) }
    }

    /// A claim that holds, on those runs.
    fn qualified(outcomes: &[Outcome]) -> Claim {
        let mut workshop = Workshop::new(PathBuf::new(), true);
        let text = "name = \"pile\"\n[base]\nscene = \"cradle\"\n";
        let study = Study::parse(text, "pile.toml".as_ref(), true).expect("a study");
        let rows = outcomes.iter().map(|&outcome| (String::new(), Config::default(), outcome));
        let table = RunsTable { rows: rows.collect(), core_secs: 0.0 };
        workshop.finished.insert("pile", (study, table));
        let mut claims = [Claim::new("it falls", "p = 0.001", Verdict::Holds)];
        workshop.qualify(&["pile"], &mut claims);
        let [claim] = claims;
        claim
    }

    #[test]
    fn one_run_that_lost_a_grain_or_did_not_end_refuses_the_verdict_and_other_alarms_are_counted() {
        let sound = outcome(Status::Done, 0, None);
        let deep = outcome(Status::Done, 0, Some(AlarmKind::Overlap));
        let lost = outcome(Status::Done, 2, Some(AlarmKind::GrainLost));
        let infinite = outcome(Status::NotFinite, 0, Some(AlarmKind::NotFinite));

        let claim = qualified(&[sound; 40]);
        assert_eq!((claim.measured.as_str(), claim.verdict), ("p = 0.001", Verdict::Holds));
        let claim = qualified(&[sound, deep, sound]);
        assert_eq!(claim.measured, "p = 0.001; 1 of 3 runs raised alarms (overlap 1)");
        assert_eq!(claim.verdict, Verdict::Holds);
        for spoilt in [lost, infinite] {
            let mut outcomes = vec![sound; 999];
            outcomes.extend([deep, spoilt]);
            let claim = qualified(&outcomes);
            assert!(claim.measured.starts_with("p = 0.001; 2 of 1001 runs raised"));
            assert!(claim.measured.ends_with(", and 1 lost grains or did not end"));
            assert_eq!(claim.verdict, Verdict::Open);
        }
    }
}
