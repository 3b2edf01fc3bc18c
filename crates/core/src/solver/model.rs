//! Choice of the model (the variant of the mechanics) that a step is compiled for, and storage for the problems of each
//! model.

use super::kinematics::{
    Line, Model, Plane, RollingPlane, ShearedPlane, SmoothPlane, SpinningPlane,
};
use super::methods::Memory;
use super::problem::StepProblem;
use crate::world::{FrictionCone, Parameters, Periodic, Physics};

/// The features of the mechanics (friction, rotation, …) that a [`Model`] computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ModelParts {
    /// Number of space dimensions, 1 or 2.
    pub axes: u8,
    /// True if the periodic borders shear: the copies (images) of grains beyond a border then move relative to the
    /// grains.
    pub sheared: bool,
    /// True if contacts have tangential (friction) impulses.
    pub friction: bool,
    /// True if grains can rotate. If contacts have no friction, no contact changes the rotation of a grain.
    pub rotation: bool,
    /// True if contacts have rolling resistance.
    pub rolling: bool,
}

impl ModelParts {
    /// Returns the smallest set of features that is sufficient for a scene (`physics`, `periodic`) and its parameters.
    /// `[friction, rolling]` are the largest friction coefficient μ and the largest coefficient of rolling friction μ_r
    /// of all contacts; a feature whose coefficient is 0 is left out. A larger set of features gives the same impulses.
    pub(crate) fn leanest(
        physics: Physics,
        periodic: Option<Periodic>,
        [friction, rolling]: [f64; 2],
    ) -> Self {
        Self {
            axes: physics.axes,
            sheared: periodic.is_some_and(Periodic::is_sheared),
            friction: physics.friction && friction > 0.0,
            rotation: physics.rotation,
            rolling: physics.rotation && rolling > 0.0,
        }
    }
}

/// Evaluates an expression for the [`Model`] that computes exactly the given [`ModelParts`]. Inside the expression a
/// type name of your choice stands for the model: `with_model!(parts, M => work::<M>())`.
#[macro_export]
macro_rules! with_model {
    ($parts:expr, $M:ident => $work:expr) => {
        $crate::with_model!(@ $parts, $M, $work,
            { sheared: true, .. } => ShearedPlane,
            { axes: 1, .. } => Line,
            { rolling: true, .. } => RollingPlane,
            { friction: false, .. } => SmoothPlane,
            { rotation: false, .. } => Plane,
            { .. } => SpinningPlane,
        )
    };
    (@ $parts:expr, $M:ident, $work:expr, $($pattern:tt => $Name:ident,)*) => {
        match $parts {
            $($crate::solver::ModelParts $pattern => {
                type $M = $crate::solver::$Name;
                $work
            })*
        }
    };
}

/// Returns the friction cone of a scene: shifted (the normal force plus the cohesion force bounds friction) or
/// compressive (only the pushing part of the normal force bounds friction). Without cohesion both cones are the same,
/// and the shifted cone is returned.
pub(crate) fn cone_of(physics: Physics, parameters: &Parameters) -> FrictionCone {
    if physics.cohesion && parameters.bond > 0.0 { parameters.cone } else { FrictionCone::Shifted }
}

/// The contact problem of a scene's present step under one model (which axes, rotation and friction it computes), and
/// the memory of the methods that solve it.
#[derive(Clone, Debug, Default)]
pub struct Slot<M: Model> {
    /// The contact problem, including its impulses and velocities.
    pub problem: StepProblem<M>,
    /// Work memory for a smaller problem that has some of the contacts of `problem` and is solved separately.
    pub part: StepProblem<M>,
    /// Work memory of the methods, reused from one solve to the next. It has no effect on results.
    pub memory: Memory,
}

/// For each model (variant of the mechanics, for example without friction), its contact problem and work memory (a
/// [`Slot`]). The memory of models that a scene does not use allocates nothing.
#[derive(Clone, Debug, Default)]
pub struct Slots {
    line: Slot<Line>,
    smooth_plane: Slot<SmoothPlane>,
    plane: Slot<Plane>,
    spinning_plane: Slot<SpinningPlane>,
    rolling_plane: Slot<RollingPlane>,
    sheared_plane: Slot<ShearedPlane>,
}

/// A model (variant of the mechanics, for example without friction) whose contact problem and work memory are stored in
/// [`Slots`].
pub trait Slotted: Model {
    /// Returns the contact problem and the work memory of this model.
    fn slot(slots: &mut Slots) -> &mut Slot<Self>;
}

macro_rules! slotted {
    ($($Name:ident: $slot:ident),*) => {
        $(impl Slotted for $Name {
            fn slot(slots: &mut Slots) -> &mut Slot<Self> {
                &mut slots.$slot
            }
        })*
    };
}
slotted!(Line: line, SmoothPlane: smooth_plane, Plane: plane, SpinningPlane: spinning_plane, RollingPlane: rolling_plane, ShearedPlane: sheared_plane);
