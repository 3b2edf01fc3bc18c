//! One step's contact problem, the methods that solve it, and the residual that judges them all.

mod kinematics;
mod measure;
mod method;
mod model;
mod newton;
mod nsgs;
mod problem;
mod settings;

pub use kinematics::{Kinematics, Line, LineBody, Plane, PlaneBody, SpinningPlane};
pub use measure::{Measures, measure, residual};
pub use method::{METHODS, Method, MethodInfo, MethodKind, Scheme, SolveReport, solve};
pub use model::{Model, ModelVisitor, StepModel, visit_leanest};
pub use problem::{Problems, Row, StepProblem};
pub use settings::{MAX_SUBSTEPS, SolverSettings, StopTest};

#[doc(hidden)]
pub use nsgs::sweep;
