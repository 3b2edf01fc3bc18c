//! Tests of the steppers `range`, `tgs-soft`, `avbd` and `dem` (all except `moreau`, the scheme of Abramian & Staron
//! 2020), and of properties of all steppers.

mod own_laws;
mod range;
mod range_shocks;
mod schemes;
mod springs;
