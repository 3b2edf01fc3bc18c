//! Grains out of files: those that recordings have, and lists of discs made elsewhere.

mod csv;
#[cfg(feature = "data")]
mod parquet;

use std::collections::HashMap;
use std::io::Read;
use std::path::{Path, PathBuf};

use ::csv::ReaderBuilder;
use glam::DVec2;

pub use self::csv::parse_grains;
#[cfg(feature = "data")]
use self::parquet::read_parts;
use super::columns::{FIXED, GRAIN, KINDS, LOST, empty_grains};
use super::csv::{COMMENT, FOLDER as CSV_FOLDER};
use super::recording_folder::{FRAMES, numbered_parts};
use super::table::Values;
use super::{lammps, vtk};
use crate::error::{Error, Result};
use crate::input::{BoundedLines, open};
use crate::world::{Disc, Grain};

/// What is read, for messages.
const FORM: &str = "a file of discs (CSV or Parquet), or a folder that --data wrote as either";
/// How Parquet files begin.
const PARQUET: &[u8] = b"PAR1";
/// How files begin that are written, but not read, and what they are.
const WRITTEN_ALONE: [(&[u8], &str); 3] =
    [(b"ITEM:", "a LAMMPS dump"), (b"<?xml", "a file of VTK"), (b"<VTKFile", "a file of VTK")];
/// Bytes of the longest of these.
const LONGEST_BEGINNING: u64 = 8;

/// Columns without which there are no discs.
const NEEDED: [&str; 3] = ["x", "y", "radius"];
/// The columns of numbers that are read, mass last.
const NUMBERS: [&str; 7] = ["x", "y", "radius", "vx", "vy", "omega", "mass"];
/// The numbers of columns that are left out. A mass that is NaN is not given.
const LEFT_OUT: [f64; NUMBERS.len()] = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, f64::NAN];
/// Relative difference of masses that counts as rounding. Smaller: masses that were written with few digits are
/// refused; larger: a scene computes with other masses than its file says.
const SAME_MASS: f64 = 1e-3;
/// Steps that a message lists.
const MOST_LISTED: usize = 8;

/// The discs of one moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordedGrains {
    /// Those that move, in the order of their ids where they have some.
    pub grains: Vec<Grain>,
    /// Those that do not.
    pub fixed_discs: Vec<Disc>,
    /// The mass of each grain over its area, kg/m², if masses are given: all grains have the same.
    pub areal_density: Option<f64>,
}

impl RecordedGrains {
    /// The columns of numbers that they are made of. Beside them the columns `id` and `kind` are read.
    pub const NUMBERS: [&str; NUMBERS.len()] = NUMBERS;

    /// Refuses grains that a file gives other masses than a scene of that density (kg/m²) has. `path` is for messages.
    ///
    /// # Errors
    /// Names both densities.
    pub fn check_masses(&self, path: &Path, areal_density: f64) -> Result<()> {
        let Some(found) = self.areal_density else { return Ok(()) };
        if is_near(found, areal_density) {
            return Ok(());
        }
        let reason = format!(
            "mass is {found:.6e} kg per m² of a disc, but must be left out or that of the scene, which has an \
             areal_density of {areal_density} kg/m²: a scene file can have another"
        );
        Err(Error::file(path, reason))
    }
}

/// True if two masses or densities differ by rounding alone. NaN is near nothing.
fn is_near(one: f64, other: f64) -> bool {
    (one - other).abs() <= SAME_MASS * other.abs()
}

/// Reads the grains of a file, or of a recording's folder, as CSV or Parquet. Where it has several moments, the last
/// is taken, or that of `step`.
///
/// # Errors
/// Where the file cannot be read or is of another format, has no such step, lacks a column, or a row is none; the
/// message names the row.
pub fn read_grains(path: &Path, step: Option<u64>) -> Result<RecordedGrains> {
    let there = std::fs::metadata(path).map_err(|error| Error::unread(path, error, FORM))?;
    if there.is_dir() { read_folder(path, step) } else { read_file(path, step) }
}

fn read_folder(folder: &Path, step: Option<u64>) -> Result<RecordedGrains> {
    // Frames that are not yet in every format are none.
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
    // Of a table that grows, a frame may be cut.
    let recording = path.parent().and_then(Path::parent);
    let wanted = match (step, recording) {
        (None, Some(recording)) => last_step(recording)?,
        (step, _) => step,
    };
    csv::read(path, wanted)
}

/// The step of the last frame of the recording in a folder; none where no such thing is told.
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
        // A row that a kill cut short is none.
        last = row.get(0).filter(|_| row.len() == 3).and_then(|step| step.parse().ok()).or(last);
    }
    Ok(last)
}

#[cfg(not(feature = "data"))]
fn read_parts(path: &Path, _: &[(u64, PathBuf)], _: Option<u64>) -> Result<RecordedGrains> {
    let reason = "is Parquet, but must be CSV in this build, which has not the feature data";
    Err(Error::file(path, reason))
}

/// The discs of columns by those names that recordings give them: numbers, and where they are there the
/// counts `id` and the words `kind`. `what` they are of is for messages.
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
/// Where a column is missing, unknown, of another length or of other values, or a row is no disc; the message
/// names it.
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
            ("id", Values::Counts(_)) | ("kind", Values::Words { .. }) => {}
            ("id", _) => return Err(refuse("id has no counts, but must be of them".into())),
            ("kind", _) => return Err(refuse("kind has no words, but must be of them".into())),
            _ => {}
        }
    }
    let column =
        |name: &str| columns.iter().find(|(known, _)| known == name).map(|(_, values)| values);
    let numbers = NUMBERS.map(column);
    let ids = column("id").map(|ids| if let Values::Counts(ids) = ids { &ids[..] } else { &[] });
    let kinds = column("kind");
    let row = |at: usize| DiscRow {
        place: at as u64,
        id: ids.map(|ids| ids[at]),
        kind: kinds.and_then(|kinds| kinds.word(at)).map(str::to_owned),
        numbers: std::array::from_fn(|place| {
            numbers[place].map_or(LEFT_OUT[place], |numbers| numbers.number(at))
        }),
    };
    let place = |row| (what.to_owned(), format!("row {row}"));
    discs_of_rows(what, (0..rows).map(row).collect(), place)
}

/// One row of a file, not yet checked.
#[derive(Debug)]
struct DiscRow {
    /// Where it is, in whatever way the file's reader tells rows.
    pub place: u64,
    pub id: Option<u64>,
    /// As the column `kind` has it; a grain where there is none.
    pub kind: Option<String>,
    /// In the order of [`NUMBERS`].
    pub numbers: [f64; NUMBERS.len()],
}

/// True if the columns are there without which there are no discs.
fn has_needed(names: &[String]) -> bool {
    NEEDED.iter().all(|needed| names.iter().any(|name| name == needed))
}

/// Refuses a file that lacks a column, or has one that nothing is known of.
fn check_names(path: &Path, names: &[String]) -> Result<()> {
    if !has_needed(names) {
        let names = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
        let reason =
            format!("the columns are {names}, but must be such that x, y and radius are there");
        return Err(Error::file(path, reason));
    }
    let Some(unknown) = unknown_of(names) else { return Ok(()) };
    let reason = format!("a column is {unknown}, but must be one of {}", known_names());
    Err(Error::file(path, reason))
}

/// The first name that no column of grains has.
fn unknown_of(names: &[String]) -> Option<&String> {
    let known = empty_grains();
    names.iter().find(|name| known.column(name).is_none())
}

/// The names of all columns of grains.
fn known_names() -> String {
    empty_grains().columns.iter().map(|column| column.name).collect::<Vec<_>>().join(", ")
}

/// That a file has no frame of a step, but those of `known`, rising.
fn no_such_step(path: &Path, step: u64, known: &[u64]) -> Error {
    let file = path.display();
    let allowed = match known {
        [] => format!("left out, since {file} tells no steps"),
        [only] => format!("{only}, the only step of {file}"),
        [first, .., last] if known.len() > MOST_LISTED => {
            format!("one of the {} steps of {file}, from {first} to {last}", known.len())
        }
        listed => {
            let listed: Vec<_> = listed.iter().map(u64::to_string).collect();
            format!("one of the steps of {file}: {}", listed.join(", "))
        }
    };
    Error::value("initial-step", step, allowed)
}

/// The discs that rows are, if they are some. `place` says a row's file, and where it is there: `line 3`.
fn discs_of_rows(
    path: &Path,
    rows: Vec<DiscRow>,
    place: impl Fn(u64) -> (PathBuf, String),
) -> Result<RecordedGrains> {
    let (mut grains, mut fixed_discs) = (Vec::new(), Vec::new());
    let mut by_id = HashMap::new();
    let mut areal_density = None;
    for row in rows {
        let refuse = |reason: String| {
            let (path, place) = place(row.place);
            Error::file(path, format!("{place}: {reason}"))
        };
        let kind = row.kind.as_deref().unwrap_or(KINDS[GRAIN]);
        if !KINDS.contains(&kind) {
            return Err(refuse(format!("kind is {kind}, but must be {}", KINDS.join(" or "))));
        }
        if let Some(id) = row.id
            && let Some(other) = by_id.insert(id, row.place)
        {
            let (_, other) = place(other);
            return Err(refuse(format!("id is {id}, but must be another than in {other}")));
        }
        // A lost grain may be anywhere, and is not to come back.
        if kind == KINDS[LOST] {
            continue;
        }
        let [x, y, radius, vx, vy, omega, mass] = row.numbers;
        if !(radius > 0.0 && radius.is_finite()) {
            return Err(refuse(format!("radius is {radius}, but must be finite and > 0")));
        }
        let mut numbers = NUMBERS.iter().zip(row.numbers);
        if let Some((name, value)) =
            numbers.find(|(name, value)| **name != "mass" && !value.is_finite())
        {
            return Err(refuse(format!("{name} is {value}, but must be finite")));
        }
        let position = DVec2::new(x, y);
        if kind == KINDS[FIXED] {
            fixed_discs.push((row.id, Disc { position, radius }));
        } else {
            if !mass.is_nan() {
                let area = std::f64::consts::PI * radius * radius;
                let density = *areal_density.get_or_insert(mass / area);
                if !(is_near(mass, density * area) && mass > 0.0 && mass.is_finite()) {
                    let allowed = if density > 0.0 && density.is_finite() {
                        format!(
                            "{:.6e}, as the first grain has {density:.6e} kg/m²",
                            density * area
                        )
                    } else {
                        "finite and > 0".to_owned()
                    };
                    return Err(refuse(format!(
                        "mass is {mass} kg, but must be left out or {allowed}: all grains of a scene have the \
                         same areal_density"
                    )));
                }
            }
            let (velocity, angular_velocity) = (DVec2::new(vx, vy), omega);
            let grain = Grain { velocity, angular_velocity, ..Grain::at_rest(position, radius) };
            grains.push((row.id, grain));
        }
    }
    if grains.is_empty() {
        return Err(Error::file(path, "holds no disc, but must hold at least one"));
    }
    let (grains, fixed_discs) = (by_their_ids(grains), by_their_ids(fixed_discs));
    Ok(RecordedGrains { grains, fixed_discs, areal_density })
}

/// In the order of the ids, or as they came where there are none.
fn by_their_ids<T>(mut discs: Vec<(Option<u64>, T)>) -> Vec<T> {
    discs.sort_by_key(|(id, _)| *id);
    discs.into_iter().map(|(_, disc)| disc).collect()
}
