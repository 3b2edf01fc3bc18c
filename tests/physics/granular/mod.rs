//! Measures of piles, against what is known of packings exactly and against what must hold of any pile.

mod by_hand;
mod cells;
mod edge_cases;
mod forces;
mod invariance;
mod network;
mod packings;
mod piles;
