//! Writes the time series of runs, as one CSV file per run in the folder `series/`, with one row per interval of
//! simulated time. The checksums of these files are in the journal (the file that stores the results of finished runs)
//! and not in the files, so that the files are plain tables.

use std::path::{Path, PathBuf};

use super::plan::SeriesSettings;
use crate::error::{Error, Result};
use crate::harness::journal;
use crate::output::{note_line, write_file};
use crate::scene::Scene;
use crate::sim::{Observables, Simulation};

pub(super) const SERIES: &str = "series";

/// Returns the path of the file with the time series of the run with the given key.
pub fn series_path(folder: &Path, key: &str) -> PathBuf {
    folder.join(SERIES).join(format!("{key}.csv"))
}

/// The time series of a run in progress: the table rows that the run has written so far.
pub(super) struct Series<'a> {
    settings: &'a SeriesSettings,
    time_step_secs: f64,
    /// Number of the next row of the time series, counted from 0. The row is written when this number of intervals of
    /// simulated time has passed.
    next: u64,
    writer: csv::Writer<Vec<u8>>,
}

impl<'a> Series<'a> {
    pub(super) fn start(settings: &'a SeriesSettings, scene: &Scene) -> Self {
        let time_step_secs = scene.parameters.time_step_secs;
        let writer = csv::WriterBuilder::new().has_headers(false).from_writer(Vec::new());
        Self { settings, time_step_secs, next: 0, writer }
    }

    /// Adds a row with the observables (measured numbers, such as the slump) and the positions of the chosen grains, if
    /// a row is due. A row is due at the first step that reaches the time of the row, up to rounding.
    pub(super) fn add_if_due(&mut self, simulation: &Simulation) -> Result<()> {
        let reached = simulation.time_secs() + 1e-6 * self.time_step_secs;
        if reached < self.next as f64 * self.settings.interval {
            return Ok(());
        }
        let refuse = |error: csv::Error| Error::file(SERIES, error);
        let (observables, grains) = (simulation.observables(), &self.settings.grains);
        if self.next == 0 {
            let places = grains.iter().flat_map(|grain| [format!("x{grain}"), format!("y{grain}")]);
            let names = column_names(observables)?;
            let names = names.split(',').map(str::to_owned).chain(places);
            self.writer.write_record(names).map_err(refuse)?;
        }
        self.next = ((reached / self.settings.interval) as u64).saturating_add(1);
        let positions = &simulation.world().grains.positions;
        let place =
            |&grain: &usize| [positions[grain].x.to_string(), positions[grain].y.to_string()];
        let places: Vec<String> = grains.iter().flat_map(place).collect();
        self.writer.serialize((observables, places)).map_err(refuse)
    }

    /// Writes the file of the time series to `folder`, and returns the checksum of the file.
    pub(super) fn finish(self, folder: &Path, key: &str) -> Result<String> {
        let bytes = self.writer.into_inner().map_err(|error| Error::file(SERIES, error.error()))?;
        let series = folder.join(SERIES);
        std::fs::create_dir_all(&series).map_err(|error| Error::file(&series, error))?;
        write_file(&series_path(folder, key), &bytes)?;
        Ok(journal::checksum(&bytes))
    }
}

/// Returns the names of the observables, separated by commas, as the header line of a CSV table. No name contains a
/// comma.
fn column_names(observables: &Observables) -> Result<String> {
    let mut table = csv::Writer::from_writer(Vec::new());
    table.serialize(observables).map_err(|error| Error::file(SERIES, error))?;
    let bytes = table.into_inner().map_err(|error| Error::file(SERIES, error.error()))?;
    Ok(String::from_utf8_lossy(&bytes).lines().next().unwrap_or_default().to_owned())
}

/// True if the file with the time series of a finished run is intact, that is, has the given checksum. A damaged file
/// is reported on the terminal.
pub(super) fn is_whole(folder: &Path, key: &str, checksum: Option<&str>) -> bool {
    let path = series_path(folder, key);
    let Ok(bytes) = std::fs::read(&path) else { return false };
    let whole = checksum == Some(journal::checksum(&bytes).as_str());
    if !whole {
        note_line(format_args!("{}: is damaged; its run is computed anew", path.display()));
    }
    whole
}
