//! The models that a step is compiled for, and where their problems are kept.

use super::kinematics::{Kinematics, Line, Plane, ShearedPlane, SpinningPlane};
use super::problem::StepProblem;
use super::solve::Memory;
use crate::world::{FrictionCone, Parameters, Periodic, Physics};

/// What a step computes. Everything here is known when the step is compiled, so a leaner model
/// has no branch for what it leaves out.
///
/// Cohesion and the cone of friction are not among it: in shifted impulses they are numbers
/// (`contact::law`).
pub trait Model: Copy + 'static {
    /// How bodies move.
    type Kinematics: Kinematics;
    /// True where contacts carry tangential impulses.
    const FRICTION: bool;
}

/// A model as a type: kinematics, then friction.
#[derive(Clone, Copy, Debug)]
pub struct StepModel<K, const FRICTION: bool>(std::marker::PhantomData<K>);

impl<K: Kinematics, const FRICTION: bool> Model for StepModel<K, FRICTION> {
    type Kinematics = K;
    const FRICTION: bool = FRICTION;
}

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

/// The cone of friction of a scene at present. Without cohesion the two are one.
pub(crate) fn cone_of(physics: Physics, parameters: &Parameters) -> FrictionCone {
    if physics.cohesion && parameters.bond > 0.0 { parameters.cone } else { FrictionCone::Shifted }
}

/// A problem, and what the methods keep that solve it.
#[derive(Clone, Debug, Default)]
pub struct Slot<K: Kinematics> {
    /// The problem.
    pub problem: StepProblem<K>,
    /// Room for some of its rows, to be solved by themselves.
    pub part: StepProblem<K>,
    /// What the methods keep.
    pub memory: Memory<K>,
}

/// A slot for each kind of motion; those that a scene never uses hold no memory.
#[derive(Clone, Debug, Default)]
pub struct Slots {
    line: Slot<Line>,
    plane: Slot<Plane>,
    spinning_plane: Slot<SpinningPlane>,
    sheared_plane: Slot<ShearedPlane>,
}

/// Something to be done with a slot once the model is known.
pub trait SlotVisitor {
    /// What it gives.
    type Output;
    /// Does it.
    fn visit<M: Model>(self, slot: &mut Slot<M::Kinematics>) -> Self::Output;
}

impl Slots {
    /// Calls `visitor` with the model that computes just these parts, and its slot.
    pub(crate) fn visit<V: SlotVisitor>(&mut self, parts: ModelParts, visitor: V) -> V::Output {
        match parts {
            // With friction, whether there is any at present or not: its bound is then 0.
            ModelParts { sheared: true, .. } => {
                visitor.visit::<StepModel<ShearedPlane, true>>(&mut self.sheared_plane)
            }
            ModelParts { axes: 1, .. } => visitor.visit::<StepModel<Line, false>>(&mut self.line),
            ModelParts { friction: false, .. } => {
                visitor.visit::<StepModel<Plane, false>>(&mut self.plane)
            }
            ModelParts { rotation: false, .. } => {
                visitor.visit::<StepModel<Plane, true>>(&mut self.plane)
            }
            _ => visitor.visit::<StepModel<SpinningPlane, true>>(&mut self.spinning_plane),
        }
    }
}

/// Something to be done once the model is known.
pub trait ModelVisitor {
    /// What it gives.
    type Output;
    /// Does it.
    fn visit<M: Model>(self) -> Self::Output;
}

/// Calls `visitor` with the model that computes just these parts.
pub fn visit_model<V: ModelVisitor>(parts: ModelParts, visitor: V) -> V::Output {
    struct WithoutSlot<V>(V);
    impl<V: ModelVisitor> SlotVisitor for WithoutSlot<V> {
        type Output = V::Output;

        fn visit<M: Model>(self, _: &mut Slot<M::Kinematics>) -> V::Output {
            self.0.visit::<M>()
        }
    }
    Slots::default().visit(parts, WithoutSlot(visitor))
}
