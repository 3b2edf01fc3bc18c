//! What the interior point keeps from one factorisation, and from one step, to the next.

use super::local::{Contact, Direction};
use super::near::Near;
use super::shape::PAIRS;
use super::system::System;
use crate::solver::methods::newton::NewtonMemory;
use crate::solver::methods::shared::contact_graph::ContactGraph;

/// A workspace for each number of degrees of freedom; those that are not used hold no memory.
#[derive(Clone, Debug, Default)]
pub(crate) struct InteriorMemory {
    pub(super) one: Workspace<1>,
    pub(super) two: Workspace<2>,
    pub(super) three: Workspace<3>,
    /// (σ, λ_t) of the rows of a problem that was not solved under Coulomb's law.
    pub(super) unsolved: Vec<[f64; 2]>,
    /// Of Newton's method, which goes on where a path leads nowhere.
    pub(super) newton: NewtonMemory,
}

/// What is kept where a body has `D` degrees of freedom.
#[derive(Clone, Debug, Default)]
pub(super) struct Workspace<const D: usize> {
    pub graph: ContactGraph,
    pub system: System<D>,
    /// By place: a right-hand side, then the change of the velocities.
    pub vector: Vec<[f64; D]>,
    /// By row.
    pub contacts: Vec<Contact>,
    pub targets: Vec<[f64; PAIRS]>,
    pub step: Vec<Direction>,
    pub other_step: Vec<Direction>,
    /// (σ, λ_t) of the rows to go back to.
    pub kept: Vec<[f64; 2]>,
    /// The same as the solve began.
    pub first: Vec<[f64; 2]>,
    /// Of the proximal multipliers, by row.
    pub near: Vec<Near>,
    /// M(V − V_free) of these, by place, kg m/s.
    pub momenta: Vec<[f64; D]>,
    /// Bodies at which a step was stopped.
    pub stopped: Vec<bool>,
}
