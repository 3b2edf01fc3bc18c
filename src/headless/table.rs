//! `observables.csv`, there from the first row on.

use std::fs::File;
use std::io::{Error as IoError, Result as IoResult, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::error::{Error, Result};
use crate::output::start_stream;
use crate::sim::Observables;

/// Rows wait no longer than this for being written, as long as steps come. Shorter: small scenes spend
/// their time in system calls; longer: more is lost when the program is killed.
const LONGEST_WAIT: Duration = Duration::from_millis(100);

/// Bytes of rows that wait. Small scenes fill them sooner than [`LONGEST_WAIT`].
const MOST_WAITING: usize = 1 << 16;

/// Bytes of a page of memory on most machines, and a part of one on all others.
const PAGE: u64 = 4096;

/// A row a step. Whole rows alone are written, so that a run that is killed, or that fills the disk,
/// leaves a table that can be read.
pub(super) struct ObservablesTable {
    path: PathBuf,
    rows: csv::Writer<WholeRows>,
    written: Instant,
}

impl ObservablesTable {
    /// Starts `observables.csv` in a folder.
    pub(super) fn start(folder: &Path) -> Result<Self> {
        Self::start_as(folder.join("observables.csv"))
    }

    /// Goes on with the first `length` bytes of `observables.csv` in a folder.
    pub(super) fn go_on(folder: &Path, length: u64) -> Result<Self> {
        let path = folder.join("observables.csv");
        let refuse = |error| Error::file(&path, error);
        let file = File::options().write(true).create(true).truncate(false).open(&path);
        let mut file = file.map_err(refuse)?;
        let found = file.metadata().map_err(refuse)?.len();
        if found < length {
            let reason = format!(
                "has {found} bytes, but must have all {length} that the checkpoint tells of"
            );
            return Err(Error::file(&path, reason));
        }
        file.set_len(length).and_then(|()| file.seek(SeekFrom::End(0))).map_err(refuse)?;
        Ok(Self::of(path, WholeRows { whole: length, ..WholeRows::new(file) }))
    }

    /// Starts a table at a path.
    pub(super) fn start_as(path: PathBuf) -> Result<Self> {
        let file = start_stream(&path)?;
        Ok(Self::of(path, WholeRows::new(file)))
    }

    /// The names of the columns are in a file that has rows.
    fn of(path: PathBuf, whole_rows: WholeRows) -> Self {
        let mut builder = csv::WriterBuilder::new();
        builder.has_headers(whole_rows.whole == 0).buffer_capacity(MOST_WAITING);
        let rows = builder.from_writer(whole_rows);
        Self { path, rows, written: Instant::now() }
    }

    /// Adds a row.
    pub(super) fn add(&mut self, observables: &Observables) -> Result<()> {
        self.rows.serialize(observables).map_err(|error| Error::file(&self.path, error))?;
        if self.written.elapsed() >= LONGEST_WAIT { self.flush() } else { Ok(()) }
    }

    /// Writes the rows that wait.
    pub(super) fn flush(&mut self) -> Result<()> {
        self.rows.flush().map_err(|error| Error::file(&self.path, error))?;
        self.written = Instant::now();
        Ok(())
    }

    /// Has all rows on the disk, and tells their length, bytes.
    pub(super) fn mark(&mut self) -> Result<u64> {
        self.flush()?;
        let WholeRows { file, whole, .. } = self.rows.get_ref();
        // Pipes and devices know no such thing.
        let _ = file.sync_data();
        Ok(*whole)
    }

    /// Writes the rows that wait and has all of them on the disk.
    pub(super) fn finish(mut self) -> Result<()> {
        self.flush()?;
        // Pipes and devices know no such thing.
        let _ = self.rows.get_ref().file.sync_all();
        Ok(())
    }
}

/// A file of rows that a kill or a full disk leaves with whole rows.
struct WholeRows {
    file: File,
    /// Length of the rows that are in the file, bytes.
    whole: u64,
    /// The beginning of a row whose end has not come yet.
    begun: Vec<u8>,
    /// Whether it took no more; rows that come later would leave a gap.
    is_full: bool,
}

impl WholeRows {
    fn new(file: File) -> Self {
        Self { file, whole: 0, begun: Vec::new(), is_full: false }
    }

    fn write_rows(&mut self, mut rows: &[u8]) -> IoResult<()> {
        while !rows.is_empty() {
            let (now, later) = rows.split_at(self.uncut(rows));
            if let Err(error) = self.file.write_all(now) {
                self.is_full = true;
                // A part of a row may be there. A pipe has taken it; a file gives it back.
                let _ = self.file.set_len(self.whole);
                return Err(error);
            }
            self.whole += now.len() as u64;
            rows = later;
        }
        Ok(())
    }

    /// How many bytes to write at once. A kill can cut a write where a page of the file ends, and only
    /// there: so rows that lie in one page are written together, and one that lies in two alone, which
    /// leaves some 0.1 µs in which it can be cut.
    fn uncut(&self, rows: &[u8]) -> usize {
        let room = (PAGE - self.whole % PAGE) as usize;
        let first = || rows.iter().position(|&byte| byte == b'\n').map(|last| last + 1);
        end_of_last(&rows[..room.min(rows.len())]).or_else(first).unwrap_or(rows.len())
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
            self.write_rows(&rows[..end])?;
            rows.drain(..end);
            self.begun = rows;
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> IoResult<()> {
        Ok(())
    }
}

/// Where the last row ends that does.
fn end_of_last(rows: &[u8]) -> Option<usize> {
    rows.iter().rposition(|&byte| byte == b'\n').map(|last| last + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_that_comes_in_parts_is_written_whole() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("rows.csv");
        let mut rows = WholeRows::new(start_stream(&path).expect("a file"));
        let read = || std::fs::read_to_string(&path).expect("rows");
        rows.write_all(b"a,b\n1,").expect("a file");
        assert_eq!(read(), "a,b\n");
        rows.write_all(b"2\n3,4\n5").expect("a file");
        assert_eq!(read(), "a,b\n1,2\n3,4\n");
    }

    #[test]
    fn no_two_rows_are_written_together_over_the_end_of_a_page() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut rows = WholeRows::new(start_stream(&folder.path().join("rows")).expect("a file"));
        let text = "a row of 17 bytes\n".repeat(1000);
        let mut rest = text.as_bytes();
        let mut alone = 0;
        while !rest.is_empty() {
            let now = rows.uncut(rest);
            let pages = [rows.whole, rows.whole + now as u64 - 1].map(|byte| byte / PAGE);
            assert_eq!(rest[now - 1], b'\n');
            assert!(pages[0] == pages[1] || now == 18, "{now} bytes over the end of a page");
            alone += u64::from(pages[0] != pages[1]);
            rows.whole += now as u64;
            rest = &rest[now..];
        }
        assert!(alone >= 3, "{alone}");
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
