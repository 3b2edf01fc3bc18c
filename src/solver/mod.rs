//! One step's contact problem, the methods that solve it, and the residual that judges them all.

mod admm;
mod apgd;
mod auto;
mod delassus;
mod impacts;
mod iterate;
mod jacobi;
mod kinematics;
mod lane_blocks;
mod measure;
mod method;
mod model;
mod newton;
mod nncg;
mod nsgs;
mod nsgs_parallel;
mod order;
mod prepare;
mod problem;
mod remedies;
mod settings;
mod stall;
mod system;
mod update;

pub use auto::picked;
pub use delassus::{Assembled, DelassusProblem, Triplets, solve_delassus};
pub use impacts::{Bounces, follow_impacts, gains_energy, scale_rebounds};
pub use kinematics::{Kinematics, Line, LineBody, Plane, PlaneBody, SpinningPlane};
pub use measure::{Measures, Motion, for_each_row, measure, relative_velocities, residual};
pub use method::{
    METHODS, Method, MethodInfo, MethodKind, Scheme, SolveReport, solve, solve_system,
};
pub use model::{Model, ModelParts, ModelVisitor, StepModel, visit_leanest, visit_model};
pub use order::Ordering;
pub use problem::{Problems, Row, StepProblem};
pub use remedies::Remedies;
pub use settings::{MAX_SUBSTEPS, SolverSettings, StopTest};
pub use system::{BodySystem, ContactSystem, Pairs, Vectors};

#[doc(hidden)]
pub use nsgs::sweep;
