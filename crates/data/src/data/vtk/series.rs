//! A `.pvd` file: which file shows which time, for ParaView.
//!
//! It grows by a frame at a time and must be whole whenever somebody reads it or the program is killed.
//! So the entries stand in slots of one length ahead of the closing tags, and what slots are free is blank:
//! a new entry is one write within one page of memory, which no kill cuts. Where none is free the file is
//! written anew with twice as many, which comes to a constant time a frame.

use std::fs::File;
use std::io::{Seek, SeekFrom, Write};
use std::path::PathBuf;

use crate::error::{Error, Result};
use crate::output::PendingFile;

/// Bytes of a slot: a part of a page, so that none lies in two, and enough for any time and name.
const SLOT: usize = 128;
/// Bytes ahead of the first slot.
const HEAD: usize = 256;
/// Slots of a file that begins.
const FIRST_SLOTS: usize = 32;

const OPENING: &str = "<?xml version=\"1.0\"?>\n\
     <VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>\n";
const CLOSING: &str = "</Collection>\n</VTKFile>\n";

/// A series of files on its way.
pub(super) struct PvdSeries {
    path: PathBuf,
    file: File,
    /// Entries.
    count: usize,
    slots: usize,
}

impl PvdSeries {
    /// A series of files of the folder that it lies in, each with its time, s.
    ///
    /// # Errors
    /// Where it cannot be written.
    pub(super) fn of(path: PathBuf, files: &[(f64, String)]) -> Result<Self> {
        let entries: Vec<u8> =
            files.iter().flat_map(|(time_secs, name)| entry(*time_secs, name)).collect();
        Self::write_anew(path, &entries, (2 * files.len()).max(FIRST_SLOTS))
    }

    /// Adds the file of a time, s, which lies in the series' folder.
    ///
    /// # Errors
    /// Where it cannot be written.
    pub(super) fn add(&mut self, time_secs: f64, file: &str) -> Result<()> {
        if self.count == self.slots {
            let text = std::fs::read(&self.path).map_err(|error| Error::file(&self.path, error))?;
            let entries = text.get(HEAD..HEAD + self.count * SLOT).unwrap_or_default();
            *self = Self::write_anew(self.path.clone(), entries, 2 * self.slots)?;
        }
        let place = HEAD + self.count * SLOT;
        let written = self.file.seek(SeekFrom::Start(place as u64));
        let written = written.and_then(|_| self.file.write_all(&entry(time_secs, file)));
        written.map_err(|error| Error::file(&self.path, error))?;
        self.count += 1;
        Ok(())
    }

    fn write_anew(path: PathBuf, entries: &[u8], slots: usize) -> Result<Self> {
        let mut file = PendingFile::start(&path)?;
        file.write(&padded(OPENING, HEAD))?;
        file.write(entries)?;
        let count = entries.len() / SLOT;
        file.write(&padded("", SLOT).repeat(slots - count))?;
        file.write(CLOSING.as_bytes())?;
        file.finish(false)?;
        let file = File::options().write(true).open(&path);
        let file = file.map_err(|error| Error::file(&path, error))?;
        Ok(Self { path, file, count, slots })
    }
}

/// A slot that is taken.
fn entry(time_secs: f64, file: &str) -> Vec<u8> {
    padded(&format!("<DataSet timestep=\"{time_secs:?}\" file=\"{file}\"/>"), SLOT)
}

/// A line of that many bytes.
fn padded(text: &str, length: usize) -> Vec<u8> {
    let mut line = format!("{:1$}", text, length - 1).into_bytes();
    line.push(b'\n');
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_time_and_name_fit_into_a_slot() {
        for time_secs in [-f64::MIN_POSITIVE, f64::MAX, 1.0 / 3.0, -1.234_567_890_123_456_7e-300] {
            let slot = entry(time_secs, &format!("contacts_{}.vtp", u64::MAX));
            assert_eq!(slot.len(), SLOT, "{}", String::from_utf8_lossy(&slot));
        }
    }
}
