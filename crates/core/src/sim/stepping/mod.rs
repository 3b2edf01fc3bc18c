//! What all ways to step share: the step's problem on its stage, the cut into pieces, the outcome.

pub(super) mod outcome;
pub(super) mod stage;

pub use outcome::{BondEnergies, Outcome};
pub use stage::{Advance, Stage};
