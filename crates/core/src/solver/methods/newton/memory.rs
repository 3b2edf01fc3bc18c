//! What Newton's method keeps from one factorisation, and from one step, to the next.

use crate::solver::linear::BlockMatrix;
use crate::solver::methods::shared::body_system::SystemMemory;
use crate::solver::methods::shared::contact_graph::ContactGraph;

/// A workspace for each number of degrees of freedom; those that are not used hold no memory.
#[derive(Clone, Debug, Default)]
pub(crate) struct NewtonMemory {
    pub(super) one: Workspace<1>,
    pub(super) two: Workspace<2>,
    pub(super) three: Workspace<3>,
    /// Of the conjugate gradients that go on where Newton's method leads nowhere.
    pub(super) gradients: SystemMemory,
}

/// What is kept where a body has `D` degrees of freedom.
#[derive(Clone, Debug, Default)]
pub(super) struct Workspace<const D: usize> {
    pub graph: ContactGraph,
    pub matrix: BlockMatrix<D>,
    pub vector: Vec<[f64; D]>,
    pub guesses: Vec<Guess>,
    /// (σ, λ_t) of the rows to go back to.
    pub saved: Vec<[f64; 2]>,
    /// (σ, λ_t) of the smallest residual so far.
    pub best: Vec<[f64; 2]>,
}

/// What the present state lets one guess of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Guess {
    Open,
    Stick,
    /// The tangential impulse is at its bound, with this sign; 0 where the bound itself is 0.
    Slip(f64),
}
