//! The steppers beside the paper's: `range`, `tgs-soft`, `avbd` and `dem`, and what all have in common.

mod avbd;
mod range;
mod range_bounces;
mod range_piles;
mod range_shocks;
mod schemes;
mod spring_numbers;
mod springs;
