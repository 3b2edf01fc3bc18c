//! Reads grains from recordings, and from lists of discs made by other programs.

mod csv;
#[cfg(feature = "data")]
mod parquet;
mod rows;

use std::io::Read;
use std::path::Path;

use ::csv::ReaderBuilder;

pub use self::csv::parse_grains;
#[cfg(feature = "data")]
use self::parquet::read_parts;
pub use self::rows::RecordedGrains;
use self::rows::{DiscRow, LEFT_OUT, NUMBERS, check_names, discs_of_rows};
use super::columns::empty_grains;
use super::csv::{COMMENT, FOLDER as CSV_FOLDER};
use super::folder_files::{FRAMES, numbered_parts};
use super::table::Values;
use super::{lammps, vtk};
use crate::error::{Error, Result};
use crate::input::{BoundedLines, open};

/// Description of a valid file, for error messages.
const FORM: &str = "a file of discs (CSV or Parquet), or a folder that --data wrote as either";
/// The bytes with which every Parquet file begins.
const PARQUET: &[u8] = b"PAR1";
/// First bytes of files that Slump writes but does not read, with the names of their formats.
const WRITTEN_ALONE: [(&[u8], &str); 3] =
    [(b"ITEM:", "a LAMMPS dump"), (b"<?xml", "a file of VTK"), (b"<VTKFile", "a file of VTK")];
/// Number of bytes read from the beginning of a file to recognise its format. No known beginning is longer.
const LONGEST_BEGINNING: u64 = 8;

/// Reads grains from a CSV or Parquet file, or from the folder of a recording. If the data have several frames, reads
/// the frame of step number `step`, or the last frame if `step` is `None`.
///
/// # Errors
/// If the file cannot be read or is of another format, has no such step, or lacks a column, or if a row is not a disc;
/// the message names the row.
pub fn read_grains(path: &Path, step: Option<u64>) -> Result<RecordedGrains> {
    let there = std::fs::metadata(path).map_err(|error| Error::unread(path, error, FORM))?;
    if there.is_dir() { read_folder(path, step) } else { read_file(path, step) }
}

fn read_folder(folder: &Path, step: Option<u64>) -> Result<RecordedGrains> {
    // The last step is taken from the list of frames, because a frame counts only after it has been written in every
    // format.
    let wanted = step.map_or_else(|| last_step(folder), |step| Ok(Some(step)));
    for parts_of in [&folder.join(empty_grains().name), folder] {
        let parts = numbered_parts(parts_of)?;
        if !parts.is_empty() {
            return read_parts(parts_of, &parts, wanted?);
        }
    }
    let text = folder.join(CSV_FOLDER).join("grains.csv");
    if text.exists() {
        return csv::read(&text, wanted?);
    }
    let is_written_alone = [vtk::BODIES.name, vtk::FIELDS.name, lammps::FOLDER]
        .iter()
        .any(|it| folder.join(it).exists());
    let found =
        if is_written_alone { "has grains for other programs alone" } else { "has no grains" };
    Err(Error::file(folder, format!("{found}, but must be {FORM}")))
}

fn read_file(path: &Path, step: Option<u64>) -> Result<RecordedGrains> {
    let mut beginning = Vec::new();
    open(path, FORM)?
        .take(LONGEST_BEGINNING)
        .read_to_end(&mut beginning)
        .map_err(|error| Error::unread(path, error, FORM))?;
    if beginning.starts_with(PARQUET) {
        return read_parts(path, &[(0, path.to_owned())], step);
    }
    if let Some((_, what)) = WRITTEN_ALONE.iter().find(|(start, _)| beginning.starts_with(start)) {
        return Err(Error::file(path, format!("is {what}, but must be {FORM}")));
    }
    // The last frame of a growing table may be incomplete, so the last step is taken from the list of frames.
    let recording = path.parent().and_then(Path::parent);
    let wanted = match (step, recording) {
        (None, Some(recording)) => last_step(recording)?,
        (step, _) => step,
    };
    csv::read(path, wanted)
}

/// Returns the number of the step of the last frame in the recording in a folder; `None` if it is unknown.
fn last_step(folder: &Path) -> Result<Option<u64>> {
    let path = folder.join(FRAMES);
    let Ok(file) = open(&path, FORM) else { return Ok(None) };
    let mut rows = ReaderBuilder::new()
        .comment(Some(COMMENT))
        .flexible(true)
        .from_reader(BoundedLines::new(file));
    let mut last = None;
    for row in rows.records() {
        let row = row.map_err(|error| Error::unread(&path, error, "the frames of a recording"))?;
        // A row that was cut short because the program was killed does not count.
        last = row.get(0).filter(|_| row.len() == 3).and_then(|step| step.parse().ok()).or(last);
    }
    Ok(last)
}

#[cfg(not(feature = "data"))]
fn read_parts(
    path: &Path,
    _: &[(u64, std::path::PathBuf)],
    _: Option<u64>,
) -> Result<RecordedGrains> {
    let reason = "is Parquet, but must be CSV in this build, which has not the feature data";
    Err(Error::file(path, reason))
}

/// Makes discs from columns that have the same names as the columns of a recording's table of grains: columns of numbers
/// and, if present, the integers `id` and the words `kind` and `material`. `what` is the name of the source in error messages.
///
/// ```
/// use slump_data::data::{Values, grains_of};
///
/// let column = |name: &str, number| (name.to_owned(), Values::Numbers(vec![number]));
/// let columns = [column("x", 0.01), column("y", 0.02), column("radius", 0.0025)];
/// let discs = grains_of("my discs".as_ref(), &columns)?;
/// assert_eq!(discs.grains[0].radius, 0.0025);
/// let refused = grains_of("my discs".as_ref(), &columns[..2]);
/// assert!(refused.is_err_and(|error| error.to_string().starts_with("my discs: the columns are x, y")));
/// # Ok::<(), slump_core::error::Error>(())
/// ```
///
/// # Errors
/// If a column is missing, unknown, of another length or of another type, or if a row is not a disc. The message names
/// the column or row.
pub fn grains_of(what: &Path, columns: &[(String, Values)]) -> Result<RecordedGrains> {
    let names: Vec<String> = columns.iter().map(|(name, _)| name.clone()).collect();
    check_names(what, &names)?;
    let refuse = |reason: String| Error::file(what, reason);
    let (first, values) = &columns[0];
    let rows = values.len();
    for (name, values) in columns {
        match (name.as_str(), values) {
            (_, values) if values.len() != rows => {
                let found = values.len();
                let reason =
                    format!("{name} has {found} rows, but must have {rows}, as {first} has");
                return Err(refuse(reason));
            }
            ("id", Values::Counts(_)) | ("kind" | "material", Values::Words { .. }) => {}
            ("id", _) => return Err(refuse("id has no counts, but must be of them".into())),
            ("kind" | "material", _) => {
                return Err(refuse(format!("{name} has no words, but must be of them")));
            }
            _ => {}
        }
    }
    let column =
        |name: &str| columns.iter().find(|(known, _)| known == name).map(|(_, values)| values);
    let numbers = NUMBERS.map(column);
    let ids = column("id").map(|ids| if let Values::Counts(ids) = ids { &ids[..] } else { &[] });
    let word = |name: &str, at: usize| column(name)?.word(at).map(str::to_owned);
    let row = |at: usize| DiscRow {
        place: at as u64,
        id: ids.map(|ids| ids[at]),
        kind: word("kind", at),
        material: word("material", at).filter(|name| !name.is_empty()),
        numbers: std::array::from_fn(|place| {
            numbers[place].map_or(LEFT_OUT[place], |numbers| numbers.number(at))
        }),
    };
    let place = |row| (what.to_owned(), format!("row {row}"));
    discs_of_rows(what, (0..rows).map(row).collect(), place)
}
