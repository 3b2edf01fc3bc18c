//! Rows of a file of discs, and their conversion to discs.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use glam::DVec2;

use crate::data::columns::{FIXED, GRAIN, KINDS, LOST, empty_grains};
use crate::error::{Error, Result};
use crate::scene::Scene;
use crate::world::{Disc, Grain};

/// Columns that every file of discs needs.
const NEEDED: [&str; 3] = ["x", "y", "radius"];
/// The numeric columns that are read, mass and areal density last.
pub(super) const NUMBERS: [&str; 8] = ["x", "y", "radius", "vx", "vy", "omega", "mass", DENSITY];
/// The areal density of a grain, kg/m²: a column that recordings do not have.
const DENSITY: &str = "density";
/// The numbers of [`NUMBERS`] that fixed discs do not have.
pub(super) const OF_GRAINS: [&str; 2] = ["mass", DENSITY];
/// The defaults for missing columns. NaN means that a mass or density is not given.
pub(super) const LEFT_OUT: [f64; NUMBERS.len()] =
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, f64::NAN, f64::NAN];
/// Largest number of steps in a message.
const MOST_LISTED: usize = 8;

/// The discs of one moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordedGrains {
    /// The discs that move, in the order of their ids if they have ids.
    pub grains: Vec<Grain>,
    /// The discs that do not move.
    pub fixed_discs: Vec<Disc>,
    /// Name of the material of each fixed disc, if the file gives one.
    pub disc_materials: Vec<Option<String>>,
}

impl RecordedGrains {
    /// The numeric columns of discs. The columns `id` and `kind` are also read.
    pub const NUMBERS: [&str; NUMBERS.len()] = NUMBERS;

    /// Gives the fixed discs to a scene, with their materials.
    ///
    /// # Errors
    /// If the scene does not list the material of a disc. `path` is for messages.
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

/// One row of a file, before the checks.
#[derive(Debug)]
pub(super) struct DiscRow {
    /// The number of the row, as the reader of the file counts.
    pub place: u64,
    pub id: Option<u64>,
    /// The word in the column `kind`. Without the column, the row is a grain.
    pub kind: Option<String>,
    /// The word in the column `material`, unless it is empty.
    pub material: Option<String>,
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
    names.iter().find(|name| known.column(name).is_none() && *name != DENSITY)
}

/// The names of all columns of grains.
pub(super) fn known_names() -> String {
    let names = empty_grains().columns.into_iter().map(|column| column.name);
    names.chain([DENSITY]).collect::<Vec<_>>().join(", ")
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

/// Sorts by ids; without ids, keeps the order.
fn by_their_ids<T>(mut discs: Vec<(Option<u64>, T)>) -> Vec<T> {
    discs.sort_by_key(|(id, _)| *id);
    discs.into_iter().map(|(_, disc)| disc).collect()
}
