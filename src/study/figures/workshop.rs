//! Where figures are made: the studies that are shipped with the program, run when a figure needs
//! them, and their rows.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::verdict::{Claim, Verdict};
use crate::error::{Error, Result};
use crate::scene::Config;
use crate::study::table::alarms_of;
use crate::study::{Outcome, RunsTable, Status, Study, SweepOptions, series_path, sweep};

/// The studies that are shipped.
const STUDIES: [(&str, &str); 8] = [
    ("pile", include_str!("../../../assets/studies/pile.toml")),
    ("cradle", include_str!("../../../assets/studies/cradle.toml")),
    ("cradle-share", include_str!("../../../assets/studies/cradle-share.toml")),
    ("cradle-map", include_str!("../../../assets/studies/cradle-map.toml")),
    ("pile-map", include_str!("../../../assets/studies/pile-map.toml")),
    ("pile-size", include_str!("../../../assets/studies/pile-size.toml")),
    ("pile-tolerance", include_str!("../../../assets/studies/pile-tolerance.toml")),
    ("range", include_str!("../../../assets/studies/range.toml")),
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
        let read = |run: &crate::study::PlannedRun| {
            let path = series_path(&self.study_folder(name), &run.key);
            let text = std::fs::read_to_string(&path).map_err(|error| Error::file(&path, error))?;
            Ok((run.config.clone(), text))
        };
        study.runs.iter().map(read).collect()
    }

    /// Says of each claim of a figure which alarms the runs of its studies raised: claims that rest on runs
    /// without a finite end, or that lost grains, are not decided.
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
            self.0.iter().filter_map(|(config, _)| config.origin.seed).collect();
        seeds.sort_unstable();
        seeds.dedup();
        seeds
    }
}
