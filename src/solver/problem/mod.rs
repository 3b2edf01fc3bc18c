//! The problem of one step: its data, how it is set up, and what judges its solution.

pub(super) mod kinematics;
mod measure;
mod model;
mod order;
pub(super) mod prepare;
mod step_problem;

pub use self::kinematics::Kinematics;
pub use self::kinematics::line::{Line, LineBody};
pub use self::kinematics::plane::{Plane, PlaneBody, SpinningPlane};
pub use self::measure::{Measures, Motion, residual};
pub(crate) use self::measure::{for_each_row, measure, relative_velocities, worst};
pub use self::model::{Model, StepModel};
pub(crate) use self::model::{ModelParts, ModelVisitor};
pub use self::step_problem::{Row, StepProblem};
