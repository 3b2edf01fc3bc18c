//! The steppers beside the paper's: `range`, `tgs-soft`, `avbd` and `dem`, and what all have in common.

mod own_laws;
mod range;
mod range_shocks;
mod schemes;
mod springs;
