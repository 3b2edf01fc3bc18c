//! Simulation of a world: time stepping, measurements after each step, and copies of the state for pictures and tables.

mod advice;
mod alarm;
mod body_forces;
mod edits;
mod force_sums;
mod losses;
mod moment;
mod numbers;
mod observables;
mod pull;
mod remedies;
mod run;
mod settings;
mod simulation;
mod snapshot;
mod state;
mod steppers;
mod stepping;
mod surroundings;
mod touch_tolerance;
mod turned_bonds;
mod walls;

pub use advice::Advice;
pub use alarm::{Alarm, AlarmKind};
pub use edits::{Edit, NEW_GRAIN_DIAMETERS, place_of};
pub use force_sums::{ForceSums, PairSum};
pub use moment::{ContactState, ContactStatus, GrainState, Moment, OtherBody};
pub use observables::{Beside, Observables, QUANTITIES, Quantity};
pub use pull::Pull;
pub use run::{RunEnding, Tally};
pub use settings::{
    FractureWork, REMEDIES, Remedies, Remedy, RemedyChanges, Settings, SpringDashpot, Stepper,
    StepperInfo,
};
pub use simulation::{ProblemVisitor, Simulation};
pub use snapshot::{ContactView, GrainView, Snapshot, hash_of_bits};
pub use stepping::{Advance, BondEnergies, Stage, StepResult};
pub use surroundings::{MotionView, Surroundings};
