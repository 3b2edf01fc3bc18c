//! Recordings on disk: what every grain and every contact did, as tables in files that other programs read.
//!
//! A [`Recording`] takes moments of a run and what its steps measure. A [`Frame`] is one moment as tables of
//! named columns with units, and a `Format` is a way to write frames. What a column is called and what it
//! holds is said once, in `columns/`; every format writes all of them. [`read_grains`] takes the grains out
//! of any of these files again.

mod claim;
mod columns;
mod csv;
mod described;
mod files;
mod format;
mod formats;
mod index;
mod lammps;
mod manifest;
#[cfg(feature = "data")]
mod parquet;
mod parts;
mod reading;
mod recording;
mod schedule;
mod table;
mod tables;
mod text_table;
mod vtk;
mod writer;

pub use crate::scene::{DataSettings, FormatName};
pub use claim::Claim;
pub use columns::Observed;
pub use format::{About, Frame};
pub use formats::{DEFAULT_FORMAT, check_format, formats_of};
pub use reading::{RecordedGrains, grains_of, parse_grains, read_grains};
pub use recording::Recording;
pub use schedule::Times;
pub use table::{Column, Table, Values};
