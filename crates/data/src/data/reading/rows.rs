//! Checks the rows of a file of discs and converts them to discs.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use glam::DVec2;

use crate::data::columns::{FIXED, GRAIN, KINDS, LOST, empty_grains};
use crate::error::{Error, Result};
use crate::scene::Scene;
use crate::world::{Disc, Grain};

/// Names of the columns that every file of discs needs.
const NEEDED: [&str; 3] = ["x", "y", "radius"];
/// Names of the numeric columns that are read from a file of discs. Mass and areal density are the last two.
pub(super) const NUMBERS: [&str; 8] = ["x", "y", "radius", "vx", "vy", "omega", "mass", DENSITY];
/// Name of the column with the areal density of a grain, kg/m². Recordings do not have this column.
const DENSITY: &str = "density";
/// Columns of [`NUMBERS`] that have no value for fixed discs.
pub(super) const OF_GRAINS: [&str; 2] = ["mass", DENSITY];
/// Default values of the columns [`NUMBERS`] for a file without these columns. NaN means that mass or density is not
/// given.
pub(super) const LEFT_OUT: [f64; NUMBERS.len()] =
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, f64::NAN, f64::NAN];
/// Largest number of steps that an error message lists one by one. If a file has more steps, the message states their
/// number, the first step and the last step.
const MOST_LISTED: usize = 8;

/// Grains and fixed discs of one step, read from a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordedGrains {
    /// Grains, the discs that can move freely. They are sorted by their ids if they have ids.
    pub grains: Vec<Grain>,
    /// Fixed discs, which are at rest or have a prescribed motion. They are sorted by their ids if they have ids.
    pub fixed_discs: Vec<Disc>,
    /// Name of the material of each fixed disc; `None` if the file names no material.
    pub disc_materials: Vec<Option<String>>,
}

impl RecordedGrains {
    /// Names of the numeric columns that are read from a file of discs. The columns `id`, `kind` and `material` are
    /// also read.
    pub const NUMBERS: [&str; NUMBERS.len()] = NUMBERS;

    /// Replaces the fixed discs of a scene by the fixed discs of a file, with their materials. `path` is the file, for
    /// error messages.
    ///
    /// # Errors
    /// If the scene has no material with the name that the file gives for a fixed disc.
    pub fn place_fixed_discs(self, scene: &mut Scene, path: &Path) -> Result<()> {
        for (number, name) in self.disc_materials.into_iter().enumerate() {
            let Some(name) = name else { continue };
            let named = scene.materials.iter_mut().find(|material| material.name == name);
            let Some(material) = named else {
                let reason =
                    format!("the material of a fixed disc is {name}, but must be one of the scene");
                return Err(Error::file(path, reason));
            };
            material.fixed_discs.push(number);
        }
        scene.fixed_discs = self.fixed_discs;
        Ok(())
    }
}

/// One row of a file of discs, before it is checked.
#[derive(Debug)]
pub(super) struct DiscRow {
    /// Number that identifies the row for an error message, such as its byte position in a CSV file.
    pub place: u64,
    pub id: Option<u64>,
    /// Word in the column `kind`. If the file has no such column, the row is a grain.
    pub kind: Option<String>,
    /// Word in the column `material`; `None` if it is empty.
    pub material: Option<String>,
    /// Values of the columns [`NUMBERS`], in their order.
    pub numbers: [f64; NUMBERS.len()],
}

/// True if `names` includes all columns that every file of discs needs.
pub(super) fn has_needed(names: &[String]) -> bool {
    NEEDED.iter().all(|needed| names.iter().any(|name| name == needed))
}

/// Fails if a needed column is missing, or if a column is unknown.
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

/// Returns the first of the column names `names` that a file of discs may not have; `None` if all names are allowed.
pub(super) fn unknown_of(names: &[String]) -> Option<&String> {
    let known = empty_grains();
    names.iter().find(|name| known.column(name).is_none() && *name != DENSITY)
}

/// Returns the names of all columns that a file of discs may have.
pub(super) fn known_names() -> String {
    let names = empty_grains().columns.into_iter().map(|column| column.name);
    names.chain([DENSITY]).collect::<Vec<_>>().join(", ")
}

/// Returns the error for a file that has no data of step number `step`. `known` lists the steps of the file in
/// ascending order.
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

/// Checks rows and converts them to discs. `place` returns the file of a row and its position in the file, such as
/// `line 3`, for error messages.
pub(super) fn discs_of_rows(
    path: &Path,
    rows: Vec<DiscRow>,
    place: impl Fn(u64) -> (PathBuf, String),
) -> Result<RecordedGrains> {
    let (mut grains, mut fixed_discs) = (Vec::new(), Vec::new());
    let mut by_id = HashMap::new();
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
        // A lost grain may be at any position, so it is not read.
        if kind == KINDS[LOST] {
            continue;
        }
        let [x, y, radius, vx, vy, omega, mass, density] = row.numbers;
        if !(radius > 0.0 && radius.is_finite()) {
            return Err(refuse(format!("radius is {radius}, but must be finite and > 0")));
        }
        let mut numbers = NUMBERS.iter().zip(row.numbers);
        if let Some((name, value)) =
            numbers.find(|(name, value)| !OF_GRAINS.contains(name) && !value.is_finite())
        {
            return Err(refuse(format!("{name} is {value}, but must be finite")));
        }
        let position = DVec2::new(x, y);
        if kind == KINDS[FIXED] {
            fixed_discs.push((row.id, (Disc { position, radius }, row.material)));
        } else {
            let area = std::f64::consts::PI * radius * radius;
            let given = [("mass", mass, "kg", mass), (DENSITY, density, "kg/m²", density * area)];
            let mut given = given.into_iter().filter(|(_, value, ..)| !value.is_nan());
            let mass = match (given.next(), given.next()) {
                (Some((name, value, unit, _)), _) if !(value > 0.0 && value.is_finite()) => {
                    return Err(refuse(format!(
                        "{name} is {value} {unit}, but must be left out or finite and > 0"
                    )));
                }
                (Some(_), Some((name, value, unit, _))) => {
                    return Err(refuse(format!(
                        "{name} is {value} {unit}, but must be left out where a mass is given"
                    )));
                }
                (mass, None) => mass.map(|(.., mass)| mass),
                (None, Some(_)) => None,
            };
            let (velocity, angular_velocity) = (DVec2::new(vx, vy), omega);
            let grain = Grain {
                velocity,
                angular_velocity,
                material: row.material,
                mass,
                ..Grain::at_rest(position, radius)
            };
            grains.push((row.id, grain));
        }
    }
    if grains.is_empty() {
        return Err(Error::file(path, "holds no disc, but must hold at least one"));
    }
    let (fixed_discs, disc_materials) = by_their_ids(fixed_discs).into_iter().unzip();
    Ok(RecordedGrains { grains: by_their_ids(grains), fixed_discs, disc_materials })
}

/// Sorts discs by their ids. Discs without ids keep their order.
fn by_their_ids<T>(mut discs: Vec<(Option<u64>, T)>) -> Vec<T> {
    discs.sort_by_key(|(id, _)| *id);
    discs.into_iter().map(|(_, disc)| disc).collect()
}
