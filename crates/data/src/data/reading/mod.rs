//! Grains out of files: those that recordings have, and lists of discs made elsewhere.

mod columns;
mod csv;
mod dump;
mod found;
#[cfg(feature = "data")]
mod parquet;
#[cfg(feature = "data")]
mod vtk;

use std::fs::File;
use std::io::Read;
use std::path::Path;

pub use self::columns::grains_of;
pub use self::csv::parse_grains;
pub use self::found::RecordedGrains;
use super::columns::empty_grains;
use super::{csv as csv_format, index, lammps, parts, vtk as vtk_format};
use crate::error::{Error, Result};

/// What is read, for messages.
const FORM: &str = "a file of discs (CSV, Parquet, .vtp, .pvd or a LAMMPS dump), or a folder \
                    that --data wrote";

/// How Parquet files begin, …
const PARQUET: &[u8] = b"PAR1";
/// … dumps of LAMMPS, …
const DUMP: &[u8] = b"ITEM:";
/// … and files of VTK.
const VTK: [&[u8]; 2] = [b"<?xml", b"<VTKFile"];
/// Bytes of the longest of these.
const LONGEST: u64 = 8;

/// Reads the grains of a file, or of a recording's folder, whatever its format. Where it has several
/// moments, the last is taken, or that of `step`.
///
/// # Errors
/// Where the file cannot be read, has no such step, lacks a column, or a row is none; the message names the
/// row.
pub fn read_grains(path: &Path, step: Option<u64>) -> Result<RecordedGrains> {
    let about = std::fs::metadata(path).map_err(|error| Error::unread(path, error, FORM))?;
    if about.is_dir() { read_folder(path, step) } else { read_file(path, step) }
}

fn read_folder(folder: &Path, step: Option<u64>) -> Result<RecordedGrains> {
    let grains = folder.join(empty_grains().name);
    let text = folder.join(csv_format::FOLDER).join("grains.csv");
    // Frames that are not yet in every format are none.
    let wanted = step.map_or_else(|| index::last_step(folder), |step| Ok(Some(step)));
    for parts_of in [grains.as_path(), folder] {
        let parts = parts::numbered(parts_of)?;
        if !parts.is_empty() {
            return read_parts(parts_of, &parts, wanted?);
        }
    }
    if text.exists() {
        return csv::read(&text, wanted?);
    }
    let series = folder.join(vtk_format::FOLDER).join(vtk_format::GRAINS);
    if series.exists() {
        return read_vtk(&series, wanted?);
    }
    let grains = folder.join(lammps::FOLDER).join(lammps::GRAINS);
    if grains.exists() {
        return dump::read(&grains, wanted?);
    }
    Err(Error::file(folder, format!("has no grains, but must be {FORM}")))
}

fn read_file(path: &Path, step: Option<u64>) -> Result<RecordedGrains> {
    let mut beginning = Vec::new();
    let file = File::open(path).map_err(|error| Error::unread(path, error, FORM))?;
    let read = file.take(LONGEST).read_to_end(&mut beginning);
    read.map_err(|error| Error::unread(path, error, FORM))?;
    if beginning.starts_with(PARQUET) {
        return read_parts(path, &[(0, path.to_owned())], step);
    }
    if VTK.iter().any(|start| beginning.starts_with(start)) {
        return read_vtk(path, step);
    }
    if beginning.starts_with(DUMP) {
        return dump::read(path, step);
    }
    // Of a table that grows, a frame may be cut.
    let recording = path.parent().and_then(Path::parent);
    let wanted = match (step, recording) {
        (None, Some(recording)) => index::last_step(recording)?,
        (step, _) => step,
    };
    csv::read(path, wanted)
}

#[cfg(feature = "data")]
use self::parquet::read_parts;
#[cfg(feature = "data")]
use self::vtk::read as read_vtk;

#[cfg(not(feature = "data"))]
fn read_parts(
    path: &Path,
    _: &[(u64, std::path::PathBuf)],
    _: Option<u64>,
) -> Result<RecordedGrains> {
    Err(without_feature(path, "Parquet"))
}

#[cfg(not(feature = "data"))]
fn read_vtk(path: &Path, _: Option<u64>) -> Result<RecordedGrains> {
    Err(without_feature(path, "a file of VTK"))
}

#[cfg(not(feature = "data"))]
fn without_feature(path: &Path, what: &str) -> Error {
    let allowed = "CSV or a LAMMPS dump in this build, which has not the feature data";
    Error::file(path, format!("is {what}, but must be {allowed}"))
}
