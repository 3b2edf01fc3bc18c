//! A place for a problem and its methods' memory, one for each kind of motion.

use super::methods::Memory;
use super::problem::{
    Kinematics, Line, Model, ModelParts, ModelVisitor, Plane, ShearedPlane, SpinningPlane,
    StepModel, StepProblem,
};

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
        let ModelParts { axes, sheared, friction, rotation, compressive_cone } = parts;
        let Self { line, plane, spinning_plane: spinning, sheared_plane } = self;
        if sheared {
            // With friction, whether there is any at present or not: its bound is then 0.
            return match compressive_cone {
                false => visitor.visit::<StepModel<ShearedPlane, true, false>>(sheared_plane),
                true => visitor.visit::<StepModel<ShearedPlane, true, true>>(sheared_plane),
            };
        }
        match (axes, friction, rotation, compressive_cone) {
            (1, ..) => visitor.visit::<StepModel<Line, false, false>>(line),
            (_, false, ..) => visitor.visit::<StepModel<Plane, false, false>>(plane),
            (_, true, false, false) => visitor.visit::<StepModel<Plane, true, false>>(plane),
            (_, true, false, true) => visitor.visit::<StepModel<Plane, true, true>>(plane),
            (_, true, true, false) => {
                visitor.visit::<StepModel<SpinningPlane, true, false>>(spinning)
            }
            (_, true, true, true) => {
                visitor.visit::<StepModel<SpinningPlane, true, true>>(spinning)
            }
        }
    }
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
