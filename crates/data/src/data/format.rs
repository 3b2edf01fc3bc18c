//! What all formats have in common.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::columns;
use super::means::Means;
use super::table::Table;
use crate::error::{Error, Result};
use crate::granular::{MomentMeasures, measure};
use crate::sim::{ForceSums, Moment, Observables};

/// What is to be known of a recording beside its tables: for the metadata of its files.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RunFacts {
    /// Names and what is said of them, none with a line break: program, command, and all that the scene
    /// says.
    pub facts: Vec<(String, String)>,
}

/// One moment that is recorded.
#[derive(Clone, Debug)]
pub struct Frame {
    /// How many were recorded before.
    pub number: u64,
    /// Where everything comes from. The tables have all of it that belongs into files.
    pub moment: Moment,
    /// A row a grain, then a row a fixed disc.
    pub grains: Table,
    /// A row a contact.
    pub contacts: Table,
    /// A row a pair that transmitted anything since the frame before.
    pub pairs: Table,
    /// A row a wall.
    pub walls: Table,
    /// One row, of the whole pile.
    pub measures: Table,
    /// A row a bin of each histogram.
    pub histograms: Table,
}

impl Frame {
    /// Makes the tables of a moment, and of what pairs have transmitted since the frame before.
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

/// How much a recording has of a run at one moment. All of it must still be there when the run is resumed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordingMark {
    /// Frames.
    pub frames: u64,
    /// Rows of the table of steps.
    pub steps: u64,
    /// Rows of the tables that each frame adds to, in the order in which `data.json` lists them.
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

/// Refuses a file or a folder of files that has lost rows, frames or the like (`things`) since the run was saved.
///
/// # Errors
/// Names it, with both counts.
pub(super) fn check_count(path: &Path, things: &str, found: u64, marked: u64) -> Result<()> {
    if found == marked {
        return Ok(());
    }
    let reason = format!(
        "has {found} {things} of the saved run, but must have all {marked}; --overwrite starts the run again"
    );
    Err(Error::file(path, reason))
}

/// A way to write frames down. It is used by one thread, which is not the solver's.
///
/// Whatever was written before stays readable whenever the program is killed. A format starts in a
/// folder that has none of its files, or, with [`Format::roll_back`] as the next call, in one that has.
pub(super) trait Format: Send {
    /// Takes the next frame. Its memory must not grow with the number of frames.
    fn add(&mut self, frame: &Frame) -> Result<()>;

    /// Takes what some steps measured, the first after the last of those before.
    fn add_steps(&mut self, _steps: &[Observables]) -> Result<()> {
        Ok(())
    }

    /// Has everything that was taken where readers find it. Called after a frame, or after several
    /// where the run is faster than the disk.
    fn flush(&mut self) -> Result<()> {
        Ok(())
    }

    fn finish(&mut self) -> Result<()> {
        self.flush()
    }

    /// Checks that all is there that was written up to `step` and to the frame of the step `last_frame`. Changes nothing.
    ///
    /// # Errors
    /// Names a file that lacks some of it.
    fn check(&self, step: u64, last_frame: Option<u64>, mark: &RecordingMark) -> Result<()>;

    /// Drops what steps after `step` measured, and all frames after that of the step `last_frame`, or all that
    /// there are, so that the run can go on from `step`.
    fn roll_back(&mut self, step: u64, last_frame: Option<u64>) -> Result<()>;
}
