//! What a simulation has done once it is known which model its scene and settings need.

use super::observables::{self, Observables};
use super::settings::Settings;
use super::state::State;
use super::steppers::Memory;
use super::stepping::{Advance, Outcome, Stage};
use crate::contact::ContactList;
use crate::solver::{Model, Slot, SlotVisitor, StepProblem};

/// Something to be done with a step's problem, before it is solved.
pub trait ProblemVisitor {
    /// What it gives.
    type Output;
    /// Does it; row `k` of the problem is contact `problem.contact_of_row()[k]` of `contacts`.
    fn visit<M: Model>(
        self,
        problem: &mut StepProblem<M::Kinematics>,
        contacts: &ContactList,
    ) -> Self::Output;
}

/// A step, and what is observed after it.
pub(super) struct Step<'a, A> {
    pub state: &'a mut State,
    pub settings: &'a Settings,
    /// Of equal length, one after the other.
    pub pieces: u32,
    pub advance: &'a mut A,
    /// Those before, and then those after the step.
    pub observables: &'a mut Observables,
    pub initial_heights: f64,
}

impl<A: Advance> SlotVisitor for Step<'_, A> {
    type Output = ();

    fn visit<M: Model>(self, slot: &mut Slot<M::Kinematics>) {
        let Self { state, settings, pieces, advance, observables, initial_heights } = self;
        let stage = &mut Stage::<M>::new(state, slot);
        let mut outcome = if pieces == 1 {
            advance.advance(stage, settings)
        } else {
            stage.in_pieces(pieces, settings, Outcome::nothing_yet(), |stage, piece, outcome| {
                outcome.add(advance.advance(stage, piece));
            })
        };
        if settings.may_solve_models() {
            outcome.measures.measure_as_a_model();
        }
        let time_step_secs = settings.parameters.time_step_secs;
        *observables =
            observables::after_step(stage, outcome, time_step_secs, observables, initial_heights);
    }
}

/// What is observed of an initial state.
pub(super) struct Start<'a> {
    pub state: &'a mut State,
    pub settings: &'a Settings,
    pub memory: &'a Memory,
    pub initial_heights: f64,
}

impl SlotVisitor for Start<'_> {
    type Output = Observables;

    fn visit<M: Model>(self, slot: &mut Slot<M::Kinematics>) -> Observables {
        let Self { state, settings, memory, initial_heights } = self;
        memory.prepare(&mut Stage::<M>::new(state, slot), settings);
        observables::at_start::<M>(state, settings, initial_heights)
    }
}

/// The first problem of a step, shown to a visitor.
pub(super) struct Show<'a, V> {
    pub state: &'a mut State,
    pub memory: &'a mut Memory,
    pub settings: &'a Settings,
    pub visitor: V,
}

impl<V: ProblemVisitor> SlotVisitor for Show<'_, V> {
    type Output = V::Output;

    fn visit<M: Model>(self, slot: &mut Slot<M::Kinematics>) -> V::Output {
        let Self { state, memory, settings, visitor } = self;
        let stage = &mut Stage::<M>::new(state, slot);
        memory.set_up(stage, settings);
        visitor.visit::<M>(stage.problem, &stage.state.contacts)
    }
}
