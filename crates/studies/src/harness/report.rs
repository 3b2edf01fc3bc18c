//! Writes the files of a report: charts and tables.

use std::path::Path;

use crate::chart::{self, Sheet};
use crate::error::{Error, Result};
use crate::output::write_file;

/// Writes a sheet of charts as `name.csv`, `name.png` and `name.svg`. The PNG file also contains the command that made
/// the chart.
pub(crate) fn write_sheet(folder: &Path, name: &str, sheet: &Sheet, command: &str) -> Result<()> {
    let path = |ending: &str| folder.join(format!("{name}.{ending}"));
    write_file(&path("csv"), &sheet.to_csv()?)?;
    write_file(&path("png"), &chart::png(sheet, command)?)?;
    write_file(&path("svg"), chart::svg(sheet)?.as_bytes())
}

/// Returns the distinct values of an iterator, in the order of their first occurrence.
pub(crate) fn distinct<T: PartialEq>(all: impl Iterator<Item = T>) -> Vec<T> {
    let mut kept: Vec<T> = Vec::new();
    for one in all {
        if !kept.contains(&one) {
            kept.push(one);
        }
    }
    kept
}

/// A table of numbers in a report, which is written as CSV and as Markdown.
pub(crate) struct ReportTable {
    pub name: String,
    pub columns: Vec<&'static str>,
    pub rows: Vec<Vec<String>>,
}

impl ReportTable {
    /// Returns a table with the given rows. `columns` contains the names of the columns, separated by spaces.
    pub(crate) fn new(
        name: impl Into<String>,
        columns: &'static str,
        rows: impl IntoIterator<Item = Vec<String>>,
    ) -> Self {
        let columns = columns.split(' ').collect();
        Self { name: name.into(), columns, rows: rows.into_iter().collect() }
    }

    pub(crate) fn to_csv(&self) -> Result<Vec<u8>> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let refuse = |error: csv::Error| Error::file(&self.name, error);
        writer.write_record(&self.columns).map_err(refuse)?;
        for row in &self.rows {
            writer.write_record(row).map_err(refuse)?;
        }
        writer.into_inner().map_err(|error| Error::file(&self.name, error.error()))
    }

    pub(crate) fn to_markdown(&self) -> String {
        let line = |cells: &[&str]| format!("| {} |\n", cells.join(" | "));
        let words: Vec<String> = self.columns.iter().map(|name| name.replace('_', " ")).collect();
        let mut text = line(&words.iter().map(String::as_str).collect::<Vec<_>>());
        text.push_str(&line(&vec!["---"; self.columns.len()]));
        for row in &self.rows {
            text.push_str(&line(&row.iter().map(String::as_str).collect::<Vec<_>>()));
        }
        text
    }
}
