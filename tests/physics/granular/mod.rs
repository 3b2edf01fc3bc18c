//! Measures of piles, against what is known of packings exactly and against what must hold of any pile.

mod cells;
mod fields;
mod invariance;
mod network;
mod packings;
mod piles;
