//! New piles, whichever way they are made.

use super::{Deposition, NewPile, Settled, Settling, drop_and_roll, rain};
use crate::error::Result;
use crate::world::Grain;

/// Makes an initial state. `progress` is called now and then; where it returns false, the settling
/// is given up with an error.
///
/// # Errors
/// Where a value is outside its range, the grains do not come to rest, or `progress` says so.
pub fn settle(pile: &NewPile, progress: impl FnMut(Settling) -> bool) -> Result<Vec<Grain>> {
    Ok(deposit(pile, progress)?.grains)
}

/// The same, with how much the grains still moved and overlapped.
///
/// # Errors
/// As [`settle`].
pub fn deposit(pile: &NewPile, progress: impl FnMut(Settling) -> bool) -> Result<Settled> {
    pile.validate()?;
    match pile.deposition {
        Deposition::Rain => rain::settled(pile, progress),
        Deposition::DropAndRoll => drop_and_roll::settled(pile, progress),
    }
}

/// The grains where they are before they settle. Quick.
pub fn start_of(pile: &NewPile) -> Vec<Grain> {
    match pile.deposition {
        Deposition::Rain => rain::lattice(pile),
        Deposition::DropAndRoll => drop_and_roll::start_of(pile),
    }
}
