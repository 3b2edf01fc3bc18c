//! `observables.csv`, there from the first row on.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use crate::error::{Error, Result};
use crate::output::GrowingFile;
use crate::sim::Observables;

/// Rows wait no longer than this for being written, as long as steps come. Shorter: small scenes spend
/// their time in system calls; longer: more is lost when the program is killed.
const LONGEST_WAIT: Duration = Duration::from_millis(100);

/// Rows that wait, some 32 kB. Small scenes fill them sooner than [`LONGEST_WAIT`].
const MOST_WAITING: usize = 128;

/// A row a step. Whole rows alone are written, so that a run that is killed, or that fills the disk,
/// leaves a table that can be read.
pub(super) struct ObservablesTable {
    path: PathBuf,
    file: GrowingFile,
    rows: csv::Writer<Vec<u8>>,
    waiting: usize,
    written: Instant,
}

impl ObservablesTable {
    pub(super) fn start(path: PathBuf) -> Result<Self> {
        let file = GrowingFile::start(path.clone())?;
        let rows = csv::Writer::from_writer(Vec::new());
        Ok(Self { path, file, rows, waiting: 0, written: Instant::now() })
    }

    pub(super) fn add(&mut self, observables: &Observables) -> Result<()> {
        self.rows.serialize(observables).map_err(|error| Error::file(&self.path, error))?;
        self.waiting += 1;
        let is_due = self.waiting >= MOST_WAITING || self.written.elapsed() >= LONGEST_WAIT;
        if is_due { self.flush() } else { Ok(()) }
    }

    pub(super) fn flush(&mut self) -> Result<()> {
        // Those that are written have had the names of the columns.
        let later = csv::WriterBuilder::new().has_headers(false).from_writer(Vec::new());
        if self.waiting > 0 {
            let rows = std::mem::replace(&mut self.rows, later).into_inner();
            let rows = rows.map_err(|error| Error::file(&self.path, error.into_error()))?;
            self.waiting = 0;
            self.file.add_rows(&rows)?;
        }
        self.written = Instant::now();
        Ok(())
    }

    /// Writes the rows that wait and has all of them on the disk.
    pub(super) fn finish(mut self) -> Result<()> {
        self.flush()?;
        self.file.sync();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_of_a_slow_scene_does_not_wait_for_others() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("observables.csv");
        let mut table = ObservablesTable::start(path.clone()).expect("a table");
        let rows = || std::fs::read_to_string(&path).expect("a table").lines().count();
        table.add(&Observables::default()).expect("a row");
        std::thread::sleep(LONGEST_WAIT);
        table.add(&Observables::default()).expect("a row");
        assert_eq!(rows(), 3);
        for _ in 0..10_000 {
            table.add(&Observables::default()).expect("a row");
        }
        assert!(rows() > 9_000, "{} rows: the others fill more than may wait", rows());
    }
}
