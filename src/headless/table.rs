//! The table `observables.csv`, which is written during the run. Each row has the observables (measured quantities)
//! after one step.

use std::io::{Error as IoError, Result as IoResult, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::folder::TABLE;
use crate::error::{Error, Result};
use crate::output::{GrowingFile, end_of_last};
use crate::sim::Observables;

/// Longest time that a row waits in memory before it is written to the file. With a shorter time, runs of small scenes
/// spend much of their time in system calls; with a longer time, more rows are missing if the process is killed.
const LONGEST_WAIT: Duration = Duration::from_millis(100);

/// Largest number of bytes of rows that wait in memory before they are written to the file. Small scenes take steps so
/// quickly that their rows reach this number before the time [`LONGEST_WAIT`] has passed.
const MOST_WAITING: usize = 1 << 16;

/// The table of observables (measured quantities), one row per step. Only whole rows are written, so that the table is
/// readable after the process was killed or the disk was full.
pub(super) struct ObservablesTable {
    path: PathBuf,
    rows: csv::Writer<WholeRows>,
    written: Instant,
}

impl ObservablesTable {
    /// Starts a new `observables.csv` in a folder.
    pub(super) fn start(folder: &Path) -> Result<Self> {
        Self::start_as(folder.join(TABLE))
    }

    /// Continues an existing `observables.csv` in a folder after its first `length` bytes.
    pub(super) fn go_on(folder: &Path, length: u64) -> Result<Self> {
        Ok(Self::of(GrowingFile::go_on(folder.join(TABLE), length)?))
    }

    /// Starts a new table of observables (measured quantities of each step) with this path.
    pub(super) fn start_as(path: PathBuf) -> Result<Self> {
        Ok(Self::of(GrowingFile::start(path)?))
    }

    /// Returns a table that writes to a file. If the file is not empty, it already has the line with the names of the
    /// columns.
    fn of(file: GrowingFile) -> Self {
        let mut builder = csv::WriterBuilder::new();
        builder.has_headers(file.length() == 0).buffer_capacity(MOST_WAITING);
        let path = file.path().to_owned();
        let rows = builder.from_writer(WholeRows::new(file));
        Self { path, rows, written: Instant::now() }
    }

    pub(super) fn add(&mut self, observables: &Observables) -> Result<()> {
        self.rows.serialize(observables).map_err(|error| Error::file(&self.path, error))?;
        if self.written.elapsed() >= LONGEST_WAIT { self.flush() } else { Ok(()) }
    }

    pub(super) fn flush(&mut self) -> Result<()> {
        self.rows.flush().map_err(|error| Error::file(&self.path, error))?;
        self.written = Instant::now();
        Ok(())
    }

    /// Flushes all rows to the disk. Returns the length of the file, bytes.
    pub(super) fn mark(&mut self) -> Result<u64> {
        self.flush()?;
        let file = &self.rows.get_ref().file;
        file.sync()?;
        Ok(file.length())
    }

    /// Writes the rows that are still in memory, and waits until all rows are on the disk.
    pub(super) fn finish(mut self) -> Result<()> {
        self.mark().map(drop)
    }
}

/// A writer that receives arbitrary pieces of text and passes only whole rows on to the file.
struct WholeRows {
    file: GrowingFile,
    /// Text of a row whose end has not been received yet.
    begun: Vec<u8>,
    /// True after a write to the file has failed. No further rows are written, because they would leave a gap in the
    /// table.
    is_full: bool,
}

impl WholeRows {
    fn new(file: GrowingFile) -> Self {
        Self { file, begun: Vec::new(), is_full: false }
    }
}

impl Write for WholeRows {
    fn write(&mut self, bytes: &[u8]) -> IoResult<usize> {
        if self.is_full {
            return Err(IoError::other("rows before could not be written"));
        }
        self.begun.extend_from_slice(bytes);
        if let Some(end) = end_of_last(&self.begun) {
            let mut rows = std::mem::take(&mut self.begun);
            self.file.add_rows(&rows[..end]).inspect_err(|_| self.is_full = true)?;
            rows.drain(..end);
            self.begun = rows;
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> IoResult<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_that_comes_in_parts_is_written_whole() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("rows.csv");
        let mut rows = WholeRows::new(GrowingFile::start(path.clone()).expect("a file"));
        let read = || std::fs::read_to_string(&path).expect("rows");
        rows.write_all(b"a,b\n1,").expect("a file");
        assert_eq!(read(), "a,b\n");
        rows.write_all(b"2\n3,4\n5").expect("a file");
        assert_eq!(read(), "a,b\n1,2\n3,4\n");
    }

    #[test]
    fn a_row_of_a_slow_scene_does_not_wait_for_others() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut table = ObservablesTable::start(folder.path()).expect("a table");
        let rows = || {
            let text = std::fs::read_to_string(folder.path().join("observables.csv"));
            text.expect("a table").lines().count()
        };
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
