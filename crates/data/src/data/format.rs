//! What all formats have in common.

use crate::error::Result;
use crate::granular::measure;
use crate::sim::{Moment, Observables};

use super::columns;
use super::table::Table;

/// What is to be known of a recording beside its tables: for the metadata of its files.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct About {
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
    /// One row, of the whole pile.
    pub measures: Table,
    /// A row a bin of each histogram.
    pub histograms: Table,
}

impl Frame {
    /// Makes the tables of a moment.
    pub fn new(number: u64, moment: Moment) -> Self {
        let measured = measure(&moment);
        let now = &moment.observables;
        Self {
            number,
            grains: columns::grains(&moment, &measured.grains),
            contacts: columns::contacts(&moment),
            measures: columns::measures(Some((now, &measured.pile))),
            histograms: columns::histograms(now, &measured.histograms),
            moment,
        }
    }

    /// All tables of a frame.
    pub(super) fn tables(&self) -> [&Table; 4] {
        [&self.grains, &self.contacts, &self.measures, &self.histograms]
    }
}

/// A way to write frames down. It is used by one thread, which is not the solver's.
///
/// Whatever was written before stays readable whenever the program is killed. A format starts in a
/// folder that has none of its files, or, with [`Format::roll_back`] as the next call, in one that has.
pub(super) trait Format: Send {
    /// Takes the next frame. Its memory must not grow with the number of frames.
    ///
    /// # Errors
    /// Where it cannot be written.
    fn add(&mut self, frame: &Frame) -> Result<()>;

    /// Takes what some steps measured, the first after the last of those before.
    ///
    /// # Errors
    /// Where they cannot be written.
    fn add_steps(&mut self, _steps: &[Observables]) -> Result<()> {
        Ok(())
    }

    /// Has everything that was taken where readers find it. Called after a frame, or after several
    /// where the run is faster than the disk.
    ///
    /// # Errors
    /// Where it cannot be written.
    fn flush(&mut self) -> Result<()>;

    /// Ends the recording.
    ///
    /// # Errors
    /// Where it cannot be written.
    fn finish(&mut self) -> Result<()> {
        self.flush()
    }

    /// Drops what steps after `step` measured, and all frames after that of the step `last_frame`, or all that
    /// there are, so that the run can go on from `step`.
    ///
    /// # Errors
    /// Where a file is not what this format wrote, or cannot be written.
    fn roll_back(&mut self, step: u64, last_frame: Option<u64>) -> Result<()>;
}
