//! One step's contact problem, the methods that solve it, and the residual that judges them all.
//!
//! * `problem/`: the problem's data, how it is set up, and its residual.
//! * `methods/`: what solves it, a file or folder a method, and the registry of all.
//! * `linear/`: the sparse factorisation that some of them use.
//! * `delassus/`: problems in the Delassus operator alone.

mod delassus;
mod linear;
mod methods;
mod ordering;
mod problem;
mod settings;
mod slots;

pub use delassus::{Assembled, DelassusProblem, Triplets, solve_delassus};
#[doc(hidden)]
pub use methods::sweep;
pub use methods::{
    BodySystem, ContactSystem, METHODS, Memory, Method, MethodInfo, MethodOrder, Pairs,
    SolveReport, Vectors, picked, solve, solve_system,
};
pub use ordering::Ordering;
pub use problem::prepare::{Approach, ProblemNumbers};
pub use problem::{
    Kinematics, Line, LineBody, Measures, Model, ModelParts, ModelVisitor, Motion, Plane,
    PlaneBody, Row, SpinningPlane, StepModel, StepProblem, for_each_row, measure,
    relative_velocities, residual,
};
pub use settings::{SolverChanges, SolverSettings, StopTest};
pub use slots::{Slot, SlotVisitor, Slots, visit_model};
