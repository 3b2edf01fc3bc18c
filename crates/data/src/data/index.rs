//! `frames.csv`: the frames that are there in every format.

use std::fs::File;
use std::path::Path;

use super::columns::{FrameRow, frames};
use super::format::About;
use super::text_table::{COMMENT, Kept, TextTable};
use crate::error::{Error, Result};

/// Its name.
pub(super) const FILE: &str = "frames.csv";

/// The list of frames. A frame is added to it when every format has it.
pub(super) struct Index(TextTable);

impl Index {
    /// An index that begins with the first frame, or is gone on with.
    pub(super) fn new(folder: &Path) -> Self {
        Self(TextTable::new(folder.join(FILE), &About::default(), &frames(&[])))
    }

    /// Adds frames.
    ///
    /// # Errors
    /// Names the file and what the system says.
    pub(super) fn add(&mut self, rows: &[FrameRow]) -> Result<()> {
        self.0.add(&frames(rows))
    }

    /// Drops what is after a step.
    ///
    /// # Errors
    /// Where the file is no such index.
    pub(super) fn roll_back(&mut self, step: u64) -> Result<Kept> {
        self.0.roll_back(Some(step))
    }
}

/// The step of the last frame of the recording in a folder; none where no such thing is told.
///
/// # Errors
/// Where there is an index that is none.
pub(super) fn last_step(folder: &Path) -> Result<Option<u64>> {
    let path = folder.join(FILE);
    let Ok(file) = File::open(&path) else { return Ok(None) };
    let mut rows =
        csv::ReaderBuilder::new().comment(Some(COMMENT)).flexible(true).from_reader(file);
    let mut last = None;
    for row in rows.records() {
        let row = row.map_err(|error| Error::unread(&path, error, "the frames of a recording"))?;
        // A row that a kill cut short is none.
        last = row.get(0).filter(|_| row.len() == 3).and_then(|step| step.parse().ok()).or(last);
    }
    Ok(last)
}
