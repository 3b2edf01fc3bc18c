//! Chooses the model that a step is compiled for, and keeps the problems of each model.

use super::kinematics::{
    Line, Model, Plane, RollingPlane, ShearedPlane, SmoothPlane, SpinningPlane,
};
use super::methods::Memory;
use super::problem::StepProblem;
use crate::world::{FrictionCone, Parameters, Periodic, Physics};

/// The parts of mechanics that a model computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ModelParts {
    /// Number of axes, 1 or 2.
    pub axes: u8,
    /// True if the periodic borders shear.
    pub sheared: bool,
    /// True if contacts carry tangential impulses.
    pub friction: bool,
    /// True if grains turn; without friction nothing turns them.
    pub rotation: bool,
    /// True if contacts resist rolling.
    pub rolling: bool,
}

impl ModelParts {
    /// The leanest model that computes everything the scene has (`physics`) and the parameters switch on: without
    /// friction if the largest μ and μ_r, `[friction, rolling]`, are 0. It gives the same impulses as a fuller model.
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

/// Evaluates an expression with the [`Model`] that computes exactly these [`ModelParts`] bound to a type name of your
/// choice: `with_model!(parts, M => work::<M>())`.
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

/// The friction cone in use. Without cohesion both cones are the same, so it is then the shifted one.
pub(crate) fn cone_of(physics: Physics, parameters: &Parameters) -> FrictionCone {
    if physics.cohesion && parameters.bond > 0.0 { parameters.cone } else { FrictionCone::Shifted }
}

/// A problem, and the memory of the methods that solve it.
#[derive(Clone, Debug, Default)]
pub struct Slot<M: Model> {
    /// The problem.
    pub problem: StepProblem<M>,
    /// Room for a subset of its rows, to be solved separately.
    pub part: StepProblem<M>,
    /// Memory of the methods.
    pub memory: Memory,
}

/// One slot per model; slots of models that a scene never uses hold no memory.
#[derive(Clone, Debug, Default)]
pub struct Slots {
    line: Slot<Line>,
    smooth_plane: Slot<SmoothPlane>,
    plane: Slot<Plane>,
    spinning_plane: Slot<SpinningPlane>,
    rolling_plane: Slot<RollingPlane>,
    sheared_plane: Slot<ShearedPlane>,
}

/// A model whose problems have a slot.
pub trait Slotted: Model {
    /// Its slot.
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
