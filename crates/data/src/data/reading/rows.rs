//! Rows of a file of discs, and the discs that they are.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use glam::DVec2;

use crate::data::columns::{FIXED, GRAIN, KINDS, LOST, empty_grains};
use crate::error::{Error, Result};
use crate::world::{Disc, Grain};

/// Columns without which there are no discs.
const NEEDED: [&str; 3] = ["x", "y", "radius"];
/// The columns of numbers that are read, mass last.
pub(super) const NUMBERS: [&str; 7] = ["x", "y", "radius", "vx", "vy", "omega", "mass"];
/// The numbers of columns that are left out. A mass that is NaN is not given.
pub(super) const LEFT_OUT: [f64; NUMBERS.len()] = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, f64::NAN];
/// Relative difference of masses that counts as rounding. Smaller: masses that were written with few digits are
/// refused; larger: a scene computes with other masses than its file says.
const SAME_MASS: f64 = 1e-3;
/// Steps that a message lists.
const MOST_LISTED: usize = 8;

/// The discs of one moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordedGrains {
    /// The discs that move, in the order of their ids if they have ids.
    pub grains: Vec<Grain>,
    /// The discs that do not move.
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

/// One row of a file, not yet checked.
#[derive(Debug)]
pub(super) struct DiscRow {
    /// The place of the row, as the reader of the file counts.
    pub place: u64,
    pub id: Option<u64>,
    /// The word of the column `kind`; a grain if there is none.
    pub kind: Option<String>,
    /// In the order of [`NUMBERS`].
    pub numbers: [f64; NUMBERS.len()],
}

/// True if all columns are there that discs need.
pub(super) fn has_needed(names: &[String]) -> bool {
    NEEDED.iter().all(|needed| names.iter().any(|name| name == needed))
}

/// Refuses a file that lacks a column, or has one that nothing is known of.
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

/// The first name that no column of grains has.
pub(super) fn unknown_of(names: &[String]) -> Option<&String> {
    let known = empty_grains();
    names.iter().find(|name| known.column(name).is_none())
}

/// The names of all columns of grains.
pub(super) fn known_names() -> String {
    empty_grains().columns.iter().map(|column| column.name).collect::<Vec<_>>().join(", ")
}

/// That a file has no frame of a step, but those of `known`, rising.
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

/// The discs of rows. `place` gives the file of a row, and its place there: `line 3`.
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

/// Sorts by ids, and keeps the order if there are none.
fn by_their_ids<T>(mut discs: Vec<(Option<u64>, T)>) -> Vec<T> {
    discs.sort_by_key(|(id, _)| *id);
    discs.into_iter().map(|(_, disc)| disc).collect()
}
