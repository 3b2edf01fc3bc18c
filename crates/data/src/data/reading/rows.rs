//! Rows of a file of discs, and their conversion to discs.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use glam::DVec2;

use crate::data::columns::{FIXED, GRAIN, KINDS, LOST, empty_grains};
use crate::error::{Error, Result};
use crate::world::{Disc, Grain};

/// Columns that every file of discs needs.
const NEEDED: [&str; 3] = ["x", "y", "radius"];
/// The numeric columns that are read, mass last.
pub(super) const NUMBERS: [&str; 7] = ["x", "y", "radius", "vx", "vy", "omega", "mass"];
/// The defaults for missing columns. A mass of NaN means that it is not given.
pub(super) const LEFT_OUT: [f64; NUMBERS.len()] = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, f64::NAN];
/// Relative difference of masses that counts as rounding. If it is smaller, masses that were written with few digits
/// are refused. If it is larger, a scene may use other masses than its file gives.
const SAME_MASS: f64 = 1e-3;
/// Largest number of steps in a message.
const MOST_LISTED: usize = 8;

/// The discs of one moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordedGrains {
    /// The discs that move, in the order of their ids if they have ids.
    pub grains: Vec<Grain>,
    /// The discs that do not move.
    pub fixed_discs: Vec<Disc>,
    /// Mass of each grain over its area, kg/m², if masses are given. It is the same for all grains.
    pub areal_density: Option<f64>,
}

impl RecordedGrains {
    /// The numeric columns of discs. The columns `id` and `kind` are also read.
    pub const NUMBERS: [&str; NUMBERS.len()] = NUMBERS;

    /// Refuses grains whose masses in a file differ from those of a scene with this areal density (kg/m²). `path` is
    /// for messages.
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

/// True if two masses or densities differ only by rounding. NaN compares false.
fn is_near(one: f64, other: f64) -> bool {
    (one - other).abs() <= SAME_MASS * other.abs()
}

/// One row of a file, before the checks.
#[derive(Debug)]
pub(super) struct DiscRow {
    /// The number of the row, as the reader of the file counts.
    pub place: u64,
    pub id: Option<u64>,
    /// The word in the column `kind`. Without the column, the row is a grain.
    pub kind: Option<String>,
    /// In the order of [`NUMBERS`].
    pub numbers: [f64; NUMBERS.len()],
}

/// True if all columns are present that discs need.
pub(super) fn has_needed(names: &[String]) -> bool {
    NEEDED.iter().all(|needed| names.iter().any(|name| name == needed))
}

/// Refuses a file that lacks a column, or has an unknown one.
pub(super) fn check_names(path: &Path, names: &[String]) -> Result<()> {
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

/// The first name that is not a column of grains.
pub(super) fn unknown_of(names: &[String]) -> Option<&String> {
    let known = empty_grains();
    names.iter().find(|name| known.column(name).is_none())
}

/// The names of all columns of grains.
pub(super) fn known_names() -> String {
    empty_grains().columns.iter().map(|column| column.name).collect::<Vec<_>>().join(", ")
}

/// Error for a file that has no frame of a step, only the steps `known`, in ascending order.
pub(super) fn no_such_step(path: &Path, step: u64, known: &[u64]) -> Error {
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

/// Converts rows to discs. `place` gives the file of a row and its place in the file: `line 3`.
pub(super) fn discs_of_rows(
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
        // A lost grain may be anywhere and is not read.
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

/// Sorts by ids; without ids, keeps the order.
fn by_their_ids<T>(mut discs: Vec<(Option<u64>, T)>) -> Vec<T> {
    discs.sort_by_key(|(id, _)| *id);
    discs.into_iter().map(|(_, disc)| disc).collect()
}
