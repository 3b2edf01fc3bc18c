//! Text files that grow by whole rows.

use std::fs::File;
use std::io::{Seek, Write};
use std::path::PathBuf;

use crate::error::{Error, Result};

/// A file that grows, so that a run that is killed, or that fills the disk, leaves a table that can be read. A kill
/// in the moment of writing may cut the last row.
pub struct GrowingFile {
    path: PathBuf,
    file: File,
    /// Length of what was written whole, bytes.
    whole: u64,
}

impl GrowingFile {
    /// Starts an empty file.
    ///
    /// # Errors
    /// Names the file and what the system says.
    pub fn start(path: PathBuf) -> Result<Self> {
        let file = File::create(&path)
            .map_err(|error| Error::file(&path, format!("cannot be written ({error})")))?;
        Ok(Self { path, file, whole: 0 })
    }

    /// Writes rows, each with its line end.
    ///
    /// # Errors
    /// Names the file and what the system says; the rows that fit stay.
    pub fn add_rows(&mut self, rows: &[u8]) -> Result<()> {
        self.add(rows, |part| part.iter().rposition(|&byte| byte == b'\n').map_or(0, |at| at + 1))
    }

    /// Writes a text that is of no use in parts.
    ///
    /// # Errors
    /// Names the file and what the system says; then it has nothing of the text.
    pub fn add_whole(&mut self, text: &[u8]) -> Result<()> {
        self.add(text, |_| 0)
    }

    /// Of a text that does not fit, the part that `stays` stays of the part that was written.
    fn add(&mut self, text: &[u8], stays: impl Fn(&[u8]) -> usize) -> Result<()> {
        if let Err(error) = self.file.write_all(text) {
            // A pipe has taken the part; a file gives it back.
            if let Ok(end) = self.file.stream_position() {
                let part = end.saturating_sub(self.whole) as usize;
                let stays = stays(&text[..part.min(text.len())]) as u64;
                let _ = self.file.set_len(self.whole + stays);
            }
            return Err(Error::file(&self.path, error));
        }
        self.whole += text.len() as u64;
        Ok(())
    }

    /// Has all of it on the disk.
    pub fn sync(&self) {
        // Pipes and devices know no such thing.
        let _ = self.file.sync_all();
    }
}
