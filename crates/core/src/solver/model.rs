//! Which model a step is compiled for, and where its problems are kept.

use super::kinematics::{Line, Model, Plane, ShearedPlane, SmoothPlane, SpinningPlane};
use super::methods::Memory;
use super::problem::StepProblem;
use crate::world::{FrictionCone, Parameters, Periodic, Physics};

/// What a model computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ModelParts {
    /// 1 or 2.
    pub axes: u8,
    /// True where borders shear.
    pub sheared: bool,
    /// True where contacts carry tangential impulses.
    pub friction: bool,
    /// True where grains turn; without friction nothing turns them.
    pub rotation: bool,
}

impl ModelParts {
    /// The leanest model that computes what the scene has (`physics`) and what is switched on at
    /// present: without friction where μ = 0. It gives the same impulses as the fuller model would.
    pub(crate) fn leanest(
        physics: Physics,
        periodic: Option<Periodic>,
        parameters: &Parameters,
    ) -> Self {
        Self {
            axes: physics.axes,
            sheared: periodic.is_some_and(Periodic::is_sheared),
            friction: physics.friction && parameters.friction > 0.0,
            rotation: physics.rotation,
        }
    }
}

/// Evaluates an expression for the [`Model`] that computes just these [`ModelParts`], by a name of your own:
/// `with_model!(parts, M => work::<M>())`.
#[macro_export]
macro_rules! with_model {
    ($parts:expr, $M:ident => $work:expr) => {
        $crate::with_model!(@ $parts, $M, $work,
            { sheared: true, .. } => ShearedPlane,
            { axes: 1, .. } => Line,
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

/// The cone of friction of a scene at present. Without cohesion the two are one.
pub(crate) fn cone_of(physics: Physics, parameters: &Parameters) -> FrictionCone {
    if physics.cohesion && parameters.bond > 0.0 { parameters.cone } else { FrictionCone::Shifted }
}

/// A problem, and what the methods keep that solve it.
#[derive(Clone, Debug, Default)]
pub struct Slot<M: Model> {
    /// The problem.
    pub problem: StepProblem<M>,
    /// Room for some of its rows, to be solved by themselves.
    pub part: StepProblem<M>,
    /// What the methods keep.
    pub memory: Memory,
}

/// A slot for each model; those that a scene never uses hold no memory.
#[derive(Clone, Debug, Default)]
pub struct Slots {
    line: Slot<Line>,
    smooth_plane: Slot<SmoothPlane>,
    plane: Slot<Plane>,
    spinning_plane: Slot<SpinningPlane>,
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
slotted!(Line: line, SmoothPlane: smooth_plane, Plane: plane, SpinningPlane: spinning_plane, ShearedPlane: sheared_plane);
