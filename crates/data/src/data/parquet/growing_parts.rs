//! A table that grows, as files each of which is whole.

use std::path::{Path, PathBuf};

use super::decode::ParquetFile;
use super::encode::Encoder;
use crate::data::format::About;
use crate::data::table::Table;
use crate::data::{files, parts};
use crate::error::{Error, Result};
use crate::output::Draft;

/// A part ends with the frame with which it comes to this size before compression, bytes. Larger: each
/// frame of a small scene costs more, since the last part is written anew with it. Smaller: more files.
const SIZE: usize = 256 << 10;

/// A table in parts. The last is written anew with each frame until it is large enough, so that a reader
/// finds whole files at any time.
pub(super) struct GrowingParts {
    folder: PathBuf,
    encoder: Encoder,
    /// Number of the part that grows.
    number: u64,
    /// Its rows.
    rows: Table,
    /// Whether it has rows that are not in its file.
    has_news: bool,
    /// Whether there is a file: a table has one, even without rows, so that readers find its columns.
    has_file: bool,
}

impl GrowingParts {
    /// Starts with no part. `rows` has none.
    ///
    /// # Errors
    /// Where the folder cannot be made, or what is said of the recording is no metadata.
    pub(super) fn start(folder: &Path, about: &About, rows: Table) -> Result<Self> {
        let folder = folder.join(rows.name);
        files::make_folder(&folder)?;
        let encoder = Encoder::new(about, &rows).map_err(|error| Error::file(&folder, error))?;
        Ok(Self { folder, encoder, number: 0, rows, has_news: false, has_file: false })
    }

    /// Adds rows, which are not parted.
    ///
    /// # Errors
    /// Where a part that is full cannot be written.
    pub(super) fn add(&mut self, rows: &Table) -> Result<()> {
        self.rows.append(rows);
        self.has_news |= !rows.is_empty();
        if self.rows.size() < SIZE { Ok(()) } else { self.end_part() }
    }

    fn end_part(&mut self) -> Result<()> {
        self.flush()?;
        self.number += 1;
        self.rows.clear();
        Ok(())
    }

    /// Writes the part that grows.
    ///
    /// # Errors
    /// Names the file and what the system says; what was there before stays.
    pub(super) fn flush(&mut self) -> Result<()> {
        if !self.has_news && self.has_file {
            return Ok(());
        }
        let path = parts::path_of(&self.folder, self.number);
        let bytes = self.encoder.encode(&self.rows).map_err(|error| Error::file(&path, error))?;
        let mut draft = Draft::start(&path)?;
        draft.write(&bytes)?;
        // A run does not wait for the disk.
        draft.finish(false)?;
        (self.has_news, self.has_file) = (false, true);
        Ok(())
    }

    /// Drops the rows after a step, or all.
    ///
    /// # Errors
    /// Where a part is not what this wrote.
    pub(super) fn roll_back(&mut self, step: Option<u64>) -> Result<()> {
        self.rows.clear();
        (self.number, self.has_news, self.has_file) = (0, false, false);
        // From the last on, so that what is left is whole whenever this is stopped.
        for (number, path) in parts::numbered(&self.folder)?.into_iter().rev() {
            let mut rows = self.rows.clone();
            ParquetFile::open(&path)?.read_into(&mut rows)?;
            if rows.steps().first().is_none_or(|&first| Some(first) > step) {
                files::remove(&path)?;
                continue;
            }
            let all = rows.len();
            rows.keep_until(step);
            (self.number, self.has_file) = (number, true);
            self.has_news = rows.len() < all;
            self.rows = rows;
            self.flush()?;
            if self.rows.size() >= SIZE {
                self.end_part()?;
            }
            return Ok(());
        }
        Ok(())
    }
}
