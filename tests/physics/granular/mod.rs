//! Tests of the measured quantities of piles against exact results for packings, and of properties that all piles have.

mod cells;
mod fields;
mod invariance;
mod network;
mod packings;
mod piles;
mod rolling_heaps;
