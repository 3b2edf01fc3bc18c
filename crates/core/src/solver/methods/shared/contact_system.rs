//! A contact problem as methods see it that treat all impulses as one vector.
//!
//! **Scaled variables.** With p = P_n + C₀Δt and u_n = v_n + ρ v_n^{n−1} a step's problem is to find
//! impulses and velocities, affine in the impulses, with
//!
//! > p = max(0, p − m_n u_n),  P_t = clamp(P_t − m_t v_t, ±bound(p)).
//!
//! In s = (p, P_t)/√m_n and w = √m_n·(u_n, v_t) the map w(s) = A s + b has a *symmetric* positive
//! semi-definite A (it is the Delassus operator between m_n^½ and m_n^½) with 1 on the diagonal of
//! every normal entry and m_n/m_t on that of every tangential one, and the conditions read
//!
//! > s_n = max(0, s_n − w_n),  s_t = clamp(s_t − w_t m_t/m_n, ±bound(s_n)).
//!
//! Both scaled quantities have the unit √J. A method written on this trait knows nothing of bodies.

use crate::solver::settings::SolverSettings;

/// Scaled impulses or velocities of all contacts: (normal, tangential) each, √J.
pub type Pairs = Vec<[f64; 2]>;

/// Vectors that a method works with. Memory is kept between steps, contents are not.
#[derive(Debug, Default)]
pub(crate) struct Vectors {
    /// As many vectors as the hungriest method needs.
    pub pairs: [Pairs; 8],
    /// One number a contact.
    pub weights: Vec<f64>,
}

impl Clone for Vectors {
    /// Nothing in them outlives a solve, so a copy of a simulation need not carry them.
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// One step's contact problem in scaled variables (see the module). `contact` is an index below
/// [`ContactSystem::len`].
pub trait ContactSystem {
    /// Whether contacts carry tangential impulses. Where they do not, tangential entries are 0.
    const FRICTION: bool;

    /// Number of contacts.
    fn len(&self) -> usize;

    /// Whether there is no contact.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The present impulses s; `impulses` is cleared first.
    fn read(&self, impulses: &mut Pairs);

    /// Takes impulses, of any sign and size, and forms the velocities that they make.
    fn write(&mut self, impulses: &[[f64; 2]]);

    /// w of the present velocities; `velocities` is cleared first.
    fn velocities(&self, velocities: &mut Pairs);

    /// m_n/m_t: the tangential entry on the diagonal of A, where the normal one is 1.
    fn tangential_diagonal(&self, contact: usize) -> f64;

    /// μ of a contact.
    fn friction(&self, contact: usize) -> f64;

    /// The largest |s_t| that a normal impulse s_n ≥ 0 allows.
    fn friction_bound(&self, contact: usize, normal: f64) -> f64;

    /// A number d > 0 a contact such that A ⪯ D⁻¹, where D has the entries (d, d m_t/m_n): with it a
    /// projected step s − D w of all contacts at once cannot diverge. `weights` is cleared first.
    fn splitting(&self, weights: &mut Vec<f64>);

    /// One Gauss–Seidel sweep from the present impulses. Leaves impulses that the laws allow.
    fn sweep(&mut self);

    /// A sweep, and whether the stopping test is met after it.
    fn tested_sweep(&mut self, settings: &SolverSettings) -> bool;

    /// The common residual of the present impulses.
    fn residual(&self) -> f64;

    /// Whether the stopping test is met by an iteration that led from the impulses `before` to the
    /// present ones.
    fn is_settled(&self, before: &[[f64; 2]], settings: &SolverSettings) -> bool;
}
