//! `observables.csv`, there from the first row on.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::output::start_stream;
use crate::sim::Observables;

/// Rows that wait for being written. Fewer cost a system call for each few steps of a small scene;
/// more are lost when the program is killed, where pictures are far apart.
const MOST_WAITING: usize = 64;

/// Bytes of a page of memory on most machines, and a part of one on all others.
const PAGE: u64 = 4096;

/// A row a step. Whole rows alone are written, so that a run that is killed, or that fills the disk,
/// leaves a table that can be read.
pub(super) struct ObservablesTable {
    path: PathBuf,
    file: File,
    waiting: csv::Writer<Vec<u8>>,
    count_waiting: usize,
    /// Length of the rows that are in the file, bytes.
    whole: u64,
}

impl ObservablesTable {
    /// Starts `observables.csv` in a folder.
    pub(super) fn start(folder: &Path) -> Result<Self> {
        Self::start_as(folder.join("observables.csv"))
    }

    /// Starts a table at a path.
    pub(super) fn start_as(path: PathBuf) -> Result<Self> {
        let file = start_stream(&path)?;
        let waiting = csv::Writer::from_writer(Vec::new());
        Ok(Self { path, file, waiting, count_waiting: 0, whole: 0 })
    }

    /// Adds a row.
    pub(super) fn add(&mut self, observables: &Observables) -> Result<()> {
        self.waiting.serialize(observables).map_err(|error| Error::file(&self.path, error))?;
        self.count_waiting += 1;
        if self.count_waiting == MOST_WAITING { self.flush() } else { Ok(()) }
    }

    /// Writes the rows that wait.
    pub(super) fn flush(&mut self) -> Result<()> {
        if self.count_waiting == 0 {
            return Ok(());
        }
        let without_names = csv::WriterBuilder::new().has_headers(false).from_writer(Vec::new());
        let rows = std::mem::replace(&mut self.waiting, without_names).into_inner();
        let rows = rows.map_err(|error| Error::file(&self.path, error.error()))?;
        self.count_waiting = 0;
        let mut rows = &rows[..];
        while !rows.is_empty() {
            let (now, later) = rows.split_at(self.uncut(rows));
            if let Err(error) = self.file.write_all(now) {
                // A part of a row may be there. A pipe has taken it; a file gives it back.
                let _ = self.file.set_len(self.whole);
                return Err(Error::file(&self.path, error));
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
        let end = |rows: &[u8]| rows.iter().rposition(|&byte| byte == b'\n').map(|last| last + 1);
        let first = || rows.iter().position(|&byte| byte == b'\n').map(|last| last + 1);
        end(&rows[..room.min(rows.len())]).or_else(first).unwrap_or(rows.len())
    }

    /// Writes the rows that wait and has all of them on the disk.
    pub(super) fn finish(mut self) -> Result<()> {
        self.flush()?;
        // Pipes and devices know no such thing.
        let _ = self.file.sync_all();
        Ok(())
    }
}
