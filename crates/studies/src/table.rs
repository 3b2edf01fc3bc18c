//! `runs.csv`: a row a run, in the study's own order, with its whole config and its outcome.

use std::collections::HashMap;
use std::path::Path;

use serde_json::Value;

use super::alarms::Alarms;
use super::outcome::{cells_of, names_of};
use super::runner::FinishedCase;
use super::sweep::SweptRun;
use super::{Outcome, Status, Study};
use crate::config::Config;
use crate::error::{Error, Result};
use crate::output::write_file;
use crate::sim::AlarmKind;

/// The results of a study.
#[derive(Clone, Debug)]
pub struct RunsTable {
    /// A run and what came of it, in the study's order.
    pub rows: Vec<(String, Config, Outcome)>,
    /// Wall-clock time of all runs together, one after the other, s. Not in the file: it is
    /// another one every time.
    pub core_secs: f64,
}

impl RunsTable {
    /// Puts finished runs in the study's order.
    pub(super) fn new(
        study: &Study,
        finished: &HashMap<String, FinishedCase<SweptRun>>,
    ) -> Result<Self> {
        let mut rows = Vec::with_capacity(study.runs.len());
        let mut core_secs = 0.0;
        for run in &study.runs {
            if let Some(case) = finished.get(&run.key) {
                core_secs += case.wall_secs;
                rows.push((run.key.clone(), run.config.clone(), case.result.outcome));
            }
        }
        let (found, all) = (rows.len(), study.runs.len());
        if found < all {
            let allowed = "complete; run the sweep or its missing parts again";
            return Err(Error::value(&study.name, format!("{found} of {all} runs"), allowed));
        }
        Ok(Self { rows, core_secs })
    }

    /// Runs whose state was no longer finite.
    pub fn not_finite(&self) -> usize {
        self.rows.iter().filter(|(.., outcome)| outcome.status == Status::NotFinite).count()
    }

    /// How many runs raised alarms, and of which kinds, in words; nothing where none did.
    pub fn alarms(&self) -> Option<String> {
        alarms_of(self.rows.iter().map(|(.., outcome)| outcome))
    }

    /// Writes the table as CSV.
    ///
    /// # Errors
    /// Names the file and what the system says.
    pub(crate) fn write(&self, path: &Path) -> Result<()> {
        write_file(path, &self.to_csv()?)
    }

    /// The table as CSV. Numbers read back bit for bit.
    ///
    /// # Errors
    /// Where a row cannot be said in CSV.
    pub(crate) fn to_csv(&self) -> Result<Vec<u8>> {
        let refuse = |error: csv::Error| Error::file("runs.csv", error);
        let fields = Config::names();
        let mut writer = csv::Writer::from_writer(Vec::new());
        let mut names = vec!["run".to_owned(), "key".to_owned()];
        names.extend(fields.iter().cloned());
        if let Some((.., outcome)) = self.rows.first() {
            names.extend(names_of(outcome)?);
        }
        writer.write_record(&names).map_err(refuse)?;
        for (number, (key, config, outcome)) in self.rows.iter().enumerate() {
            let said = serde_json::to_value(config)
                .map_err(|error| Error::value("config", key, error.to_string()))?;
            let mut cells = vec![number.to_string(), key.clone()];
            cells.extend(fields.iter().map(|field| match said.get(field) {
                None | Some(Value::Null) => String::new(),
                Some(Value::String(text)) => text.clone(),
                Some(other) => other.to_string(),
            }));
            cells.extend(cells_of(outcome)?);
            writer.write_record(&cells).map_err(refuse)?;
        }
        writer.into_inner().map_err(|error| Error::file("runs.csv", error.error()))
    }
}

/// How many of some runs raised alarms, in words: "3 of 40 runs raised alarms (overlap 2, grain-lost 1)";
/// nothing where none did.
pub(super) fn alarms_of<'a>(outcomes: impl Iterator<Item = &'a Outcome>) -> Option<String> {
    let (mut all, mut alarmed, mut by_kind) = (0, 0, [0; AlarmKind::ALL.len()]);
    for outcome in outcomes {
        all += 1;
        alarmed += u32::from(outcome.alarms != Alarms::default());
        for (count, kind) in by_kind.iter_mut().zip(AlarmKind::ALL) {
            *count += u32::from(outcome.alarms.has(kind));
        }
    }
    let counts = AlarmKind::ALL.iter().zip(by_kind).filter(|(_, count)| *count > 0);
    let counts: Vec<_> = counts.map(|(kind, count)| format!("{} {count}", kind.name())).collect();
    let counts = counts.join(", ");
    (alarmed > 0).then(|| format!("{alarmed} of {all} runs raised alarms ({counts})"))
}
