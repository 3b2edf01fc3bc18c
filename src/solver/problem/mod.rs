//! The problem of one step: its data, how it is set up, and what judges its solution.

pub mod kinematics;
mod measure;
mod model;
mod order;
pub mod prepare;
mod step_problem;

pub use self::kinematics::Kinematics;
pub use self::kinematics::line::{Line, LineBody};
pub use self::kinematics::plane::{Plane, PlaneBody, SpinningPlane};
pub use self::measure::{Measures, Motion, for_each_row, measure, relative_velocities, residual};
pub use self::model::{Model, ModelParts, ModelVisitor, StepModel};
pub use self::step_problem::{Row, StepProblem};
