//! One step's contact problem, the methods that solve it, and the residual that judges them all.
//!
//! * `problem/`: the problem's data, how it is set up, and its residual.
//! * `methods/`: what solves it, a file or folder a method, and the registry of all.
//! * `linear/`: the sparse factorisation that some of them use.
//! * `delassus/`: problems in the Delassus operator alone.

mod delassus;
mod friction_model;
mod linear;
mod methods;
mod ordering;
mod problem;
mod settings;
mod slots;

pub use delassus::Assembled;
pub use delassus::{DelassusProblem, Triplets, solve_delassus};
pub use friction_model::{Fallback, FrictionModel};
pub(crate) use methods::picked;
#[doc(hidden)]
pub use methods::sweep;
pub use methods::{
    BodySystem, ContactSystem, METHODS, Memory, Method, MethodInfo, MethodOrder, Pairs,
    SolveReport, solve,
};
pub use ordering::Ordering;
pub use problem::prepare::{Approach, ProblemNumbers};
pub use problem::worst;
pub use problem::{
    DrivenBy, DrivenRow, DrivenWall, ModelParts, ModelVisitor, Surface, for_each_row, measure,
    relative_velocities,
};
pub use problem::{
    Kinematics, Line, LineBody, Measures, Model, Motion, Plane, PlaneBody, Row, ShearedPlane,
    SlidingNormal, SpinningPlane, StepModel, StepProblem, residual,
};
pub use settings::{SolverChanges, SolverSettings, StopTest};
pub use slots::{Slot, SlotVisitor, Slots, visit_model};
