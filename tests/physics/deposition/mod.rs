//! Piles made by drop and roll: where single discs come to lie, what holds of every packing, and that a
//! settled pile stays.

mod packings;
mod settled;
mod single_discs;
