//! Other piles: what the settings of a world make of piles that differ from its own in their seed alone, so that a
//! number of one pile stands beside its mean over several.
//!
//! Piles are chaotic, and the shipped one was chosen for showing the pattern: its seed is never among the others.
//! They run on cores that are idle, from the start to the scene's end, with one set of settings. A run whose
//! settings changed on the way, or which a hand pulled in, is none that they could be compared with.

mod band;
mod crew;
mod following;
mod handle;
mod lowest;
mod part;
mod piles;
mod tasks;
mod words;

pub(crate) use self::band::Band;
pub use self::handle::OtherPiles;
