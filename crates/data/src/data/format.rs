//! The interface of all formats, and the data that they write.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::columns;
use super::means::Means;
use super::table::Table;
use crate::error::{Error, Result};
use crate::granular::{MomentMeasures, measure};
use crate::sim::{ForceSums, Moment, Observables};

/// Facts about a recording in addition to its tables, for the metadata of its files.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RunFacts {
    /// Names and values without line breaks: program, command, and all values of the scene.
    pub facts: Vec<(String, String)>,
}

/// One recorded moment.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Number of earlier frames.
    pub number: u64,
    /// The moment that the tables were made from. The tables contain everything that is written to files.
    pub moment: Moment,
    /// One row per grain, then one row per fixed disc.
    pub grains: Table,
    /// One row per contact.
    pub contacts: Table,
    /// One row per pair that transmitted a force since the frame before.
    pub pairs: Table,
    /// One row per wall.
    pub walls: Table,
    /// One row for the whole pile.
    pub measures: Table,
    /// One row per bin of each histogram.
    pub histograms: Table,
}

impl Frame {
    /// Makes the tables of a moment, and of the forces that pairs have transmitted since the frame before.
    pub fn new(number: u64, moment: Moment, sums: &ForceSums) -> Self {
        let MomentMeasures { pile, grains, histograms } = measure(&moment);
        let now = &moment.observables;
        let means = Means::of(sums, &moment, &grains, pile.area);
        Self {
            number,
            grains: columns::grains(&moment, &grains).beside(means.grains),
            contacts: Table::of_contacts(&moment),
            pairs: means.pairs,
            walls: Table::of_walls(&moment).beside(means.walls),
            measures: columns::measures(Some((now, &pile))).beside(means.pile),
            histograms: columns::histogram_table(now, &histograms),
            moment,
        }
    }

    pub(super) fn tables(&self) -> [&Table; 6] {
        let Self { grains, contacts, pairs, walls, measures, histograms, .. } = self;
        [grains, contacts, pairs, walls, measures, histograms]
    }
}

/// The extent of a recording at one moment of a run. All of it must still exist when the run is resumed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordingMark {
    /// Number of frames.
    pub frames: u64,
    /// Number of rows of the table of steps.
    pub steps: u64,
    /// Number of rows of the tables that each frame adds to, in the order in which `data.json` lists them.
    pub rows: [u64; 6],
}

impl RecordingMark {
    pub(super) fn add(&mut self, frame: &Frame) {
        self.frames += 1;
        self.rows
            .iter_mut()
            .zip(frame.tables())
            .for_each(|(rows, table)| *rows += table.len() as u64);
    }
}

/// Refuses a file or a folder of files that has lost `things` (rows, frames, …) since the run was saved.
///
/// # Errors
/// Names the file or folder, with both counts.
pub(super) fn check_count(path: &Path, things: &str, found: u64, marked: u64) -> Result<()> {
    if found == marked {
        return Ok(());
    }
    let reason = format!(
        "has {found} {things} of the saved run, but must have all {marked}; --overwrite starts the run again"
    );
    Err(Error::file(path, reason))
}

/// A file format for frames. It is used by one thread, which is not the solver's.
///
/// Whenever the program is killed, everything that was written before stays readable. A format starts in a folder
/// without its files, or, if the next call is [`Format::roll_back`], in a folder with them.
pub(super) trait Format: Send {
    /// Writes the next frame. Memory must not grow with the number of frames.
    fn add(&mut self, frame: &Frame) -> Result<()>;

    /// Writes the measurements of some steps, which follow the steps before.
    fn add_steps(&mut self, _steps: &[Observables]) -> Result<()> {
        Ok(())
    }

    /// Makes everything that was added visible to readers. Called after a frame, or after several frames if the run is
    /// faster than the disk.
    fn flush(&mut self) -> Result<()> {
        Ok(())
    }

    fn finish(&mut self) -> Result<()> {
        self.flush()
    }

    /// Checks that everything written up to `step`, and up to the frame of the step `last_frame`, still exists. Changes
    /// nothing.
    ///
    /// # Errors
    /// Names a file that has lost a part of it.
    fn check(&self, step: u64, last_frame: Option<u64>, mark: &RecordingMark) -> Result<()>;

    /// Drops the measurements of steps after `step`, and all frames after that of the step `last_frame` (all frames if
    /// it is `None`), so that the run can resume from `step`.
    fn roll_back(&mut self, step: u64, last_frame: Option<u64>) -> Result<()>;
}
