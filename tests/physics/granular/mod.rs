//! Measures of piles, against exact results for packings and against properties of all piles.

mod cells;
mod fields;
mod invariance;
mod network;
mod packings;
mod piles;
