//! Tests of the steppers other than the paper's (`range`, `tgs-soft`, `avbd`, `dem`), and of properties of all
//! steppers.

mod own_laws;
mod range;
mod range_shocks;
mod schemes;
mod springs;
