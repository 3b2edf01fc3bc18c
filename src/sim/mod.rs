//! The step, what it measures, and what it shows.

mod observables;
mod snapshot;

pub use observables::Observables;
pub use snapshot::{ContactView, GrainView, Snapshot, Surroundings};
