//! The contact problem of one step, the methods that solve it, and the residual that measures the error of every
//! method.
//!
//! * `kinematics`, `model`: velocities at contacts, and the models (variants of the mechanics) that a step is compiled
//!   for.
//! * `problem/`: the data of a problem, its set-up and its residual.
//! * `method`, `settings`: the list of methods, and the accuracy to which a step is to be solved.
//! * `methods/`: one file or folder per method.
//! * `solve`: calls the method that the settings name.
//! * `solutions`: search for several solutions of one step from several initial impulses.
//! * `onlooker`: progress reports of long solves.
//! * `linear/`: the sparse factorisations that some methods use.
//! * `delassus/`: contact problems that are given by the Delassus operator, without bodies.

mod delassus;
mod kinematics;
mod linear;
mod method;
mod methods;
mod model;
mod onlooker;
mod problem;
mod settings;
mod solutions;
mod solve;

pub use delassus::{Assembled, DelassusProblem, Triplets, solve_delassus};
pub use kinematics::{
    Line, LineBody, Model, Plane, PlaneBody, RollingPlane, ShearedPlane, SlidingNormal,
    SmoothPlane, SpinningPlane,
};
pub use method::{METHODS, Method, MethodInfo, MethodOrder, Ordering};
pub(crate) use methods::picked;
#[cfg(test)]
pub(crate) use methods::solve_within_bounds;
#[doc(hidden)]
pub use methods::sweep;
pub use methods::{
    BodySystem, CONTACTS_THAT_FLOW, ContactSystem, Memory, ScaledVector, SolveReport,
};
pub(crate) use model::cone_of;
pub use model::{ModelParts, Slot, Slots, Slotted};
pub use onlooker::{SolveProgress, is_ended, look_on};
pub use problem::{
    Approach, Bodies, ContactRows, DrivenBy, DrivenRow, DrivenWall, FixedRow, Measures,
    MovingSurfaces, NumbersOfContact, PairRow, ProblemNumbers, Rolling, Row, RowVelocities,
    StepProblem, Surface, VelocityError, for_each_row, measure, relative_velocities, residual,
    velocity_error, worst,
};
pub use settings::{FrictionModel, SolverChanges, SolverSettings, StopTest};
pub use solutions::{
    Solution, SolutionSearch, distance_to_velocities, velocities, velocity_distance,
};
pub use solve::solve;
