//! The courses of a study's runs: a CSV a run in `series/`. The journal has the checksum of each, so that
//! the files stay plain tables.

use std::path::{Path, PathBuf};

use super::outcome::{series_cells, series_names};
use super::runner::FinishedCase;
use super::sweep::SweptRun;
use super::{SeriesSettings, record};
use crate::error::{Error, Result};
use crate::output::{note_line, remove_folder_if_there, write_file};
use crate::sim::Simulation;

/// Folder of the runs' courses.
const SERIES: &str = "series";

/// Where the course of the run with a key lies.
pub fn series_path(folder: &Path, key: &str) -> PathBuf {
    folder.join(SERIES).join(format!("{key}.csv"))
}

/// The course of one run that goes on; empty where none is kept.
pub(super) struct Course<'a> {
    series: Option<&'a SeriesSettings>,
    writer: Option<csv::Writer<Vec<u8>>>,
}

impl<'a> Course<'a> {
    /// Starts with no row.
    pub(super) fn start(series: Option<&'a SeriesSettings>) -> Self {
        Self { series, writer: None }
    }

    /// Adds the row of a moment.
    ///
    /// # Errors
    /// Where it cannot be said in CSV.
    pub(super) fn add(&mut self, simulation: &Simulation) -> Result<()> {
        let Some(series) = self.series else { return Ok(()) };
        if self.writer.is_none() {
            self.writer = Some(csv::Writer::from_writer(Vec::new()));
            self.write(&series_names(simulation, &series.grains)?)?;
        }
        self.write(&series_cells(simulation, &series.grains)?)
    }

    fn write(&mut self, cells: &[String]) -> Result<()> {
        match &mut self.writer {
            Some(writer) => writer.write_record(cells).map_err(|error| Error::file(SERIES, error)),
            None => Ok(()),
        }
    }

    /// Writes the file and gives its checksum; none where no course is kept.
    ///
    /// # Errors
    /// Names the file and what the system says.
    pub(super) fn finish(self, folder: &Path, key: &str) -> Result<Option<String>> {
        let Some(writer) = self.writer else { return Ok(None) };
        let bytes = writer.into_inner().map_err(|error| Error::file(SERIES, error.error()))?;
        let path = series_path(folder, key);
        if let Some(series) = path.parent() {
            std::fs::create_dir_all(series).map_err(|error| Error::file(series, error))?;
        }
        write_file(&path, &bytes)?;
        Ok(Some(record::checksum(&bytes)))
    }
}

/// Whether the course of a finished run is there as it was written. One that is damaged is told of.
pub(super) fn is_whole(folder: &Path, case: &FinishedCase<SweptRun>) -> bool {
    let path = series_path(folder, &case.key);
    let Ok(bytes) = std::fs::read(&path) else { return false };
    let whole = case.result.series.as_ref() == Some(&record::checksum(&bytes));
    if !whole {
        note_line(format_args!("{}: is damaged; its run is computed anew", path.display()));
    }
    whole
}

/// Removes the courses of all runs.
///
/// # Errors
/// Names the folder and what the system says.
pub(super) fn remove_all(folder: &Path) -> Result<()> {
    remove_folder_if_there(&folder.join(SERIES))
}
