//! The problem of one step: its data, how it is set up, and what judges its solution.

mod driven;
mod driven_walls;
mod duality;
mod groups;
mod held;
mod islands;
pub(super) mod kinematics;
mod measure;
mod model;
mod motion;
mod order;
pub(super) mod prepare;
mod step_problem;
mod surface;
mod surfaces;
mod tiles;

pub use self::driven::DrivenBy;
pub use self::driven::DrivenRow;
pub use self::driven::DrivenWall;
pub(crate) use self::held::{Bound, Held, LawNumbers, Opening};
pub(crate) use self::islands::{Island, Islands};
pub use self::kinematics::Kinematics;
pub use self::kinematics::line::{Line, LineBody};
pub use self::kinematics::plane::{Plane, PlaneBody, SpinningPlane};
pub use self::kinematics::sheared::{ShearedPlane, SlidingNormal};
pub use self::measure::{Measures, residual};
pub(crate) use self::measure::{
    errors, held_residual, natural_map, residual_of, squared_residual_scale,
};
pub use self::measure::{measure, worst};
pub use self::model::ModelParts;
pub use self::model::ModelVisitor;
pub use self::model::{Model, StepModel};
pub use self::motion::Motion;
pub use self::motion::for_each_row;
pub use self::motion::relative_velocities;
pub use self::step_problem::{Row, StepProblem};
pub use self::surface::Surface;
