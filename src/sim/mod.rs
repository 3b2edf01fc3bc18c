//! The step, what it measures, and what it shows.

mod alarm;
mod check;
mod elasticity;
pub mod live;
mod losses;
mod moment;
mod observables;
mod pull;
mod remedies;
mod run;
mod settings;
mod simulation;
mod snapshot;
mod state;
mod steady;
mod steppers;
mod stepping;
mod tally;
mod views;
mod visits;
mod walls;

pub use alarm::{Alarm, AlarmKind};
pub use elasticity::SweepElasticity;
pub(crate) use elasticity::diffusion_of_sweep;
pub use moment::{ContactState, ContactStatus, GrainState, Moment, OtherBody};
pub use observables::{Beside, Observables, QUANTITIES, Quantity};
pub use pull::Pull;
pub use remedies::{ROWS as REMEDIES, Remedies, Remedy, RemedyChanges};
pub use run::RunEnding;
pub use settings::Settings;
pub use simulation::Simulation;
pub use snapshot::{ContactView, GrainView, MotionView, Snapshot, Surroundings};
pub use steppers::{FractureWork, SpringDashpot, Stepper, StepperInfo};
pub use stepping::{Advance, BondEnergies, Outcome, Stage};
pub use tally::Tally;
pub use visits::ProblemVisitor;
