//! What files say of grains, checked.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use glam::DVec2;

use crate::data::columns::{FIXED, GRAIN, KINDS, LOST};
use crate::error::{Error, Result};
use crate::world::{Disc, Grain};

/// Columns without which there are no discs.
const NEEDED: [&str; 3] = ["x", "y", "radius"];
/// The columns of numbers that are read. Those that are left out are 0.
pub(in crate::data) const NUMBERS: [&str; 6] = ["x", "y", "radius", "vx", "vy", "omega"];
/// Steps that a message lists.
const MOST_LISTED: usize = 8;

/// The discs of one moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordedGrains {
    /// Those that move, in the order of their ids where they have some.
    pub grains: Vec<Grain>,
    /// Those that do not.
    pub fixed_discs: Vec<Disc>,
}

impl RecordedGrains {
    /// The columns of numbers that they are made of. Beside them the columns `id` and `kind` are read.
    pub const NUMBERS: [&str; NUMBERS.len()] = NUMBERS;
}

/// One row of a file, not yet checked.
#[derive(Debug)]
pub(in crate::data) struct FoundRow {
    /// Where it is, in whatever way the file's reader tells rows.
    pub place: u64,
    pub id: Option<u64>,
    /// As the column `kind` has it; a grain where there is none.
    pub kind: Option<String>,
    /// In the order of [`NUMBERS`].
    pub numbers: [f64; NUMBERS.len()],
}

/// Whether the columns are there without which there are no discs.
pub(in crate::data) fn has_needed(names: &[String]) -> bool {
    NEEDED.iter().all(|needed| names.iter().any(|name| name == needed))
}

/// Refuses a file that lacks a column.
///
/// # Errors
/// Says which columns it has.
pub(in crate::data) fn check_names(path: &Path, names: &[String]) -> Result<()> {
    if has_needed(names) {
        return Ok(());
    }
    let names = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
    let reason =
        format!("the columns are {names}, but must be such that x, y and radius are there");
    Err(Error::file(path, reason))
}

/// That a file has no frame of a step, but those of `known`, rising.
pub(in crate::data) fn no_such_step(path: &Path, step: u64, known: &[u64]) -> Error {
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
///
/// # Errors
/// Names the first row that is none, and what of it.
pub(in crate::data) fn checked(
    path: &Path,
    rows: Vec<FoundRow>,
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
        // A lost grain may be anywhere, and is not to come back.
        if kind == KINDS[LOST] {
            continue;
        }
        let [x, y, radius, vx, vy, omega] = row.numbers;
        if !(radius > 0.0 && radius.is_finite()) {
            return Err(refuse(format!("radius is {radius}, but must be finite and > 0")));
        }
        let mut numbers = NUMBERS.iter().zip(row.numbers);
        if let Some((name, value)) = numbers.find(|(_, value)| !value.is_finite()) {
            return Err(refuse(format!("{name} is {value}, but must be finite")));
        }
        let position = DVec2::new(x, y);
        if kind == KINDS[FIXED] {
            fixed_discs.push((row.id, Disc { position, radius }));
        } else {
            let (velocity, angular_velocity) = (DVec2::new(vx, vy), omega);
            let grain = Grain { velocity, angular_velocity, ..Grain::at_rest(position, radius) };
            grains.push((row.id, grain));
        }
    }
    if grains.is_empty() {
        return Err(Error::file(path, "holds no disc, but must hold at least one"));
    }
    Ok(RecordedGrains { grains: by_their_ids(grains), fixed_discs: by_their_ids(fixed_discs) })
}

/// In the order of the ids, or as they came where there are none.
fn by_their_ids<T>(mut discs: Vec<(Option<u64>, T)>) -> Vec<T> {
    discs.sort_by_key(|(id, _)| *id);
    discs.into_iter().map(|(_, disc)| disc).collect()
}
