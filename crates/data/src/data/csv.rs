//! Recordings as text: a growing table of each kind of row, `csv/grains.csv` and so on.

use std::path::{Path, PathBuf};

use super::columns::{empty_tables, steps};
use super::files;
use super::format::{About, Format, Frame};
use super::table::Table;
use super::text_table::{self, TextTable};
use crate::error::Result;
use crate::sim::Observables;

/// Where the tables are.
pub(super) const FOLDER: &str = "csv";

/// Writes text.
pub(super) struct Csv {
    of_frames: [TextTable; 4],
    steps: TextTable,
}

impl Csv {
    /// Starts, or goes on with what is there.
    ///
    /// # Errors
    /// Where the folder cannot be made.
    pub(super) fn start(folder: &Path, about: &About) -> Result<Self> {
        let folder = folder.join(FOLDER);
        files::make_folder(&folder)?;
        let start = |table: Table| {
            TextTable::new(folder.join(format!("{}.csv", table.name)), about, &table)
        };
        let (of_frames, steps) = empty_tables();
        Ok(Self { of_frames: of_frames.map(start), steps: start(steps) })
    }
}

/// The files that are there.
///
/// # Errors
/// Where the folder cannot be read.
pub(super) fn files(folder: &Path) -> Result<Vec<PathBuf>> {
    let (of_frames, steps) = empty_tables();
    let names: Vec<_> = of_frames.iter().chain([&steps]).map(|table| table.name).collect();
    text_table::named(&folder.join(FOLDER), &names)
}

impl Format for Csv {
    fn add(&mut self, frame: &Frame) -> Result<()> {
        let tables = self.of_frames.iter_mut().zip(frame.tables());
        tables.into_iter().try_for_each(|(text, table)| text.add(table))
    }

    fn add_steps(&mut self, rows: &[Observables]) -> Result<()> {
        self.steps.add(&steps(rows))
    }

    fn flush(&mut self) -> Result<()> {
        Ok(())
    }

    fn finish(&mut self) -> Result<()> {
        let mut tables = self.of_frames.iter_mut().chain([&mut self.steps]);
        tables.try_for_each(TextTable::finish)
    }

    fn roll_back(&mut self, step: u64, last_frame: Option<u64>) -> Result<()> {
        for table in &mut self.of_frames {
            table.roll_back(last_frame)?;
        }
        self.steps.roll_back(Some(step)).map(drop)
    }
}
