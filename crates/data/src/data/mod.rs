//! Writes and reads recordings: tables of all grains and contacts of a run, in files that other programs can read.
//!
//! A [`Recording`] receives snapshots of a run and the measurements of its steps. A [`Frame`] is one snapshot as tables
//! of named columns with units. A `Format` writes frames to files. The names and meanings of columns are declared once,
//! in `columns`, and every format writes all columns. [`read_grains`] reads the grains back from CSV and Parquet.

mod columns;
mod csv;
mod folder_files;
mod format;
mod formats;
mod lammps;
mod means;
mod other_bodies;
#[cfg(feature = "data")]
mod parquet;
mod reading;
mod recording;
mod recording_folder;
mod table;
mod vtk;
mod walls;

pub use crate::scene::{DataSettings, FormatName};
pub use columns::STEP_COLUMNS;
pub use format::{Frame, RecordingMark, RunFacts};
pub use formats::{DEFAULT_FORMAT, check_format, formats_of};
pub use reading::{RecordedGrains, grains_of, parse_grains, read_grains};
pub use recording::{FrameSchedule, Recording, Times};
pub(crate) use recording_folder::facts_of_recording;
pub use recording_folder::{RecordingFolder, remove_recording};
pub use table::{Column, Table, Values};
