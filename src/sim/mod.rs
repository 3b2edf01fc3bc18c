//! The step, what it measures, and what it shows.

mod alarm;
mod bonds;
mod bounces;
mod detection;
pub mod live;
mod observables;
mod pull;
mod push_out;
mod range_step;
mod schemes;
mod shocks;
mod simulation;
mod snapshot;
mod speculative;
mod step;
mod tally;
mod travel;
mod walls;

pub use alarm::{Alarm, AlarmKind};
pub use observables::Observables;
pub use pull::Pull;
pub use schemes::SpringDashpot;
pub use simulation::Simulation;
pub use snapshot::{ContactView, GrainView, Snapshot, Surroundings};
pub use step::ProblemVisitor;
pub use tally::Tally;
