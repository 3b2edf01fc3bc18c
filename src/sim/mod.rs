//! The step, what it measures, and what it shows.

mod observables;
mod simulation;
mod snapshot;
mod step;
mod tally;

pub use observables::Observables;
pub use simulation::Simulation;
pub use snapshot::{ContactView, GrainView, Snapshot, Surroundings};
pub use tally::Tally;
