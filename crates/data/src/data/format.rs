//! Defines the interface of all file formats of recordings, and the data that are written in these formats.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::columns;
use super::means::Means;
use super::table::Table;
use crate::error::{Error, Result};
use crate::granular::{MomentMeasures, measure};
use crate::sim::{ForceSums, Moment, Observables};

/// Metadata of a recorded run, which are written into its files in addition to the tables.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RunFacts {
    /// Entries (name, value) without line breaks: program, command, and all values of the scene.
    pub facts: Vec<(String, String)>,
}

/// Frame of a recording: a snapshot of the simulation, and the tables made from it.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Number of the frame in the recording, from 0.
    pub number: u64,
    /// Snapshot of the simulation from which the tables were made.
    pub moment: Moment,
    /// Table of grains: one row per grain, then one row per fixed disc.
    pub grains: Table,
    /// Table of contacts: one row per contact.
    pub contacts: Table,
    /// Table of pairs: one row per pair of bodies between which a contact force acted since the previous frame.
    pub pairs: Table,
    /// Table of walls: one row per wall. A wall is a rigid body made of boundaries and fixed discs.
    pub walls: Table,
    /// Table of measures, such as stress and solid fraction: one row for the whole pile.
    pub measures: Table,
    /// Table of histograms: one row per bin of each histogram.
    pub histograms: Table,
}

impl Frame {
    /// Makes the tables of the snapshot `moment`. `number` is the number of earlier frames, and `sums` are the sums of
    /// the contact forces of each pair of bodies since the previous frame.
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

/// Size of a recording when its run was saved: numbers of frames and rows. All of them must still be in the files when
/// the run resumes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordingMark {
    /// Number of frames in the recording.
    pub frames: u64,
    /// Number of rows in the table of steps.
    pub steps: u64,
    /// Number of rows in each table to which every frame adds rows, in the order of the tables in a [`Frame`].
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

/// Fails if a file, or a folder of files, no longer has all `things` (rows, frames, …) that it had when the run was
/// saved.
///
/// # Errors
/// The error names the file or folder, the number found, and the number when the run was saved.
pub(super) fn check_count(path: &Path, things: &str, found: u64, marked: u64) -> Result<()> {
    if found == marked {
        return Ok(());
    }
    let reason = format!(
        "has {found} {things} of the saved run, but must have all {marked}; --overwrite starts the run again"
    );
    Err(Error::file(path, reason))
}

/// Writer of a recording in one file format. Writers run on a thread of their own, not on the thread of the solver.
///
/// If the program is killed, all data written before remain readable. If the folder has no files of the format, a new
/// writer can write at once. If it has such files, [`Format::roll_back`] must be called before anything is written.
pub(super) trait Format: Send {
    /// Writes the next frame. The used memory must not grow with the number of frames.
    fn add(&mut self, frame: &Frame) -> Result<()>;

    /// Writes the measurements of some steps. These steps follow the steps written before.
    fn add_steps(&mut self, _steps: &[Observables]) -> Result<()> {
        Ok(())
    }

    /// Makes all added data visible to programs that read the files. It is called after each frame, or after several
    /// frames if the run is faster than the disk.
    fn flush(&mut self) -> Result<()> {
        Ok(())
    }

    fn finish(&mut self) -> Result<()> {
        self.flush()
    }

    /// Checks that the files still have the measurements of all steps up to step number `step`, and all frames up to
    /// step number `last_frame` (no frames if it is `None`). `mark` has the numbers of frames and rows that must be
    /// there. Changes no file.
    ///
    /// # Errors
    /// The error names a file that has lost data.
    fn check(&self, step: u64, last_frame: Option<u64>, mark: &RecordingMark) -> Result<()>;

    /// Removes the measurements of all steps after step number `step`, and all frames after step number `last_frame`
    /// (all frames if it is `None`), so that the run can resume from `step`.
    fn roll_back(&mut self, step: u64, last_frame: Option<u64>) -> Result<()>;
}
