//! Recordings as Parquet: a folder a table, of files that are whole.

mod decode;
mod encode;
mod growing_parts;
mod rows;

pub(super) use decode::{Decoded, ParquetFile};

use std::path::Path;

use super::columns::{empty_tables, steps};
use super::format::{About, Format, Frame};
use crate::error::Result;
use crate::sim::Observables;
use growing_parts::GrowingParts;

/// Writes Parquet.
pub(super) struct Parquet {
    of_frames: Vec<GrowingParts>,
    steps: GrowingParts,
}

impl Parquet {
    /// Starts, or goes on with what is there.
    ///
    /// # Errors
    /// Where a folder cannot be made.
    pub(super) fn start(folder: &Path, about: &About) -> Result<Self> {
        let start = |table| GrowingParts::start(folder, about, table);
        let (of_frames, steps) = empty_tables();
        let of_frames = of_frames.into_iter().map(start).collect::<Result<_>>()?;
        Ok(Self { of_frames, steps: start(steps)? })
    }
}

impl Format for Parquet {
    fn add(&mut self, frame: &Frame) -> Result<()> {
        let mut tables = self.of_frames.iter_mut().zip(frame.tables());
        tables.try_for_each(|(parts, table)| parts.add(table))
    }

    fn add_steps(&mut self, rows: &[Observables]) -> Result<()> {
        self.steps.add(&steps(rows))
    }

    fn flush(&mut self) -> Result<()> {
        let mut tables = self.of_frames.iter_mut().chain([&mut self.steps]);
        tables.try_for_each(GrowingParts::flush)
    }

    fn roll_back(&mut self, step: u64, last_frame: Option<u64>) -> Result<()> {
        self.of_frames.iter_mut().try_for_each(|parts| parts.roll_back(last_frame))?;
        self.steps.roll_back(Some(step))
    }
}
