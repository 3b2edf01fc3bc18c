//! A contact problem as methods see it that treat all impulses as one vector, and the one in which
//! impulses move bodies.
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

use super::measure::residual;
use super::nsgs::{sweep, tested_sweep};
use super::{Kinematics, Model, Row, SolverSettings, StepProblem, StopTest};

/// Scaled impulses or velocities of all contacts: (normal, tangential) each, √J.
pub type Pairs = Vec<[f64; 2]>;

/// Vectors that a method works with. Memory is kept between steps, contents are not.
#[derive(Debug, Default)]
pub struct Vectors {
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

/// The problem of a step: impulses move bodies, and A is never formed.
#[derive(Debug)]
pub struct BodySystem<'a, M: Model> {
    problem: &'a mut StepProblem<M::Kinematics>,
}

impl<'a, M: Model> BodySystem<'a, M> {
    /// Contacts are numbered as the rows: those with fixed bodies first.
    pub fn new(problem: &'a mut StepProblem<M::Kinematics>) -> Self {
        let StepProblem { root_masses, fixed_rows, pair_rows, .. } = &mut *problem;
        root_masses.clear();
        root_masses
            .extend(fixed_rows.iter().chain(pair_rows.iter()).map(|row| row.effective_mass.sqrt()));
        Self { problem }
    }

    /// √m_n of a contact, kg^½: P = √m_n s.
    pub fn root_mass(&self, contact: usize) -> f64 {
        self.problem.root_masses[contact]
    }

    /// Rows with √m_n, kg^½.
    fn rows(&self) -> impl Iterator<Item = (&Row<M::Kinematics>, &f64)> {
        let StepProblem { root_masses, fixed_rows, pair_rows, .. } = &*self.problem;
        fixed_rows.iter().chain(pair_rows).zip(root_masses)
    }
}

impl<M: Model> ContactSystem for BodySystem<'_, M> {
    const FRICTION: bool = M::FRICTION;

    fn len(&self) -> usize {
        self.problem.root_masses.len()
    }

    fn read(&self, impulses: &mut Pairs) {
        impulses.clear();
        impulses.extend(
            self.rows()
                .map(|(row, root)| [root * row.shifted_impulse, root * row.tangential_impulse]),
        );
    }

    fn write(&mut self, impulses: &[[f64; 2]]) {
        let StepProblem { root_masses, fixed_rows, pair_rows, .. } = &mut *self.problem;
        let rows = fixed_rows.iter_mut().chain(pair_rows);
        for ((row, root), [normal, tangential]) in rows.zip(root_masses).zip(impulses) {
            row.shifted_impulse = normal / *root;
            if M::FRICTION {
                row.tangential_impulse = tangential / *root;
            }
        }
        self.problem.form_velocities();
    }

    fn velocities(&self, velocities: &mut Pairs) {
        let StepProblem { bodies, root_masses, fixed_rows, pair_rows, .. } = &*self.problem;
        let (fixed_roots, pair_roots) = root_masses.split_at(fixed_rows.len());
        let scaled = |row: &Row<M::Kinematics>, root: f64, [normal, tangential]: [f64; 2]| {
            let tangential = if M::FRICTION { root * tangential } else { 0.0 };
            [root * (normal + row.restitution_velocity), tangential]
        };
        velocities.clear();
        velocities.extend(fixed_rows.iter().zip(fixed_roots).map(|(row, &root)| {
            scaled(row, root, M::Kinematics::velocity(row.normal, &bodies[row.i as usize]))
        }));
        velocities.extend(pair_rows.iter().zip(pair_roots).map(|(row, &root)| {
            let (i, j) = (&bodies[row.i as usize], &bodies[row.j as usize]);
            scaled(row, root, M::Kinematics::relative_velocity(row.normal, i, j))
        }));
    }

    #[inline(always)]
    fn tangential_diagonal(&self, _contact: usize) -> f64 {
        M::Kinematics::TANGENTIAL_COMPLIANCE
    }

    #[inline(always)]
    fn friction(&self, _contact: usize) -> f64 {
        self.problem.friction
    }

    #[inline(always)]
    fn friction_bound(&self, contact: usize, normal: f64) -> f64 {
        if M::COMPRESSIVE_CONE {
            let root = self.problem.root_masses[contact];
            root * self.problem.friction_bound::<M>(normal / root)
        } else {
            self.problem.friction_bound::<M>(normal)
        }
    }

    /// Mass splitting (R. Tonge, F. Benevolenski, A. Voroshilov 2012): a body with k contacts is cut
    /// into k parts of 1/k of its mass and inertia, one a contact. By Cauchy–Schwarz the parts,
    /// moved each on its own, answer at least as much as the body does: A ⪯ D⁻¹. For the contact's
    /// own diagonal, 1/m_i becomes k_i/m_i, and with g_i = m_ij/m_i
    ///
    /// > 1/d = k_i g_i + k_j (1 − g_i), against a fixed body k_i.
    fn splitting(&self, weights: &mut Vec<f64>) {
        let StepProblem { bodies, fixed_rows, pair_rows, .. } = &*self.problem;
        // Counts come first in the same memory, one a body.
        let count = bodies.len();
        weights.clear();
        weights.resize(count, 0.0);
        for row in fixed_rows {
            weights[row.i as usize] += 1.0;
        }
        for row in pair_rows {
            weights[row.i as usize] += 1.0;
            weights[row.j as usize] += 1.0;
        }
        for row in fixed_rows {
            weights.push(1.0 / weights[row.i as usize]);
        }
        for row in pair_rows {
            let (i, j) = (weights[row.i as usize], weights[row.j as usize]);
            weights.push(1.0 / (row.share * i + (1.0 - row.share) * j));
        }
        weights.drain(..count);
    }

    fn sweep(&mut self) {
        sweep::<M, false>(self.problem);
    }

    fn tested_sweep(&mut self, settings: &SolverSettings) -> bool {
        tested_sweep::<M>(self.problem, settings)
    }

    fn residual(&self) -> f64 {
        residual::<M>(self.problem)
    }

    fn is_settled(&self, before: &[[f64; 2]], settings: &SolverSettings) -> bool {
        let tolerance = settings.tolerance;
        if settings.stop == StopTest::Residual {
            return self.residual() <= tolerance;
        }
        // Impulses in N·s, and without the shift.
        let (mut squared, mut absolute, mut whole) = (0.0, 0.0, 0.0);
        for ((number, (row, root)), [normal, tangential]) in self.rows().enumerate().zip(before) {
            let mass = row.effective_mass;
            let mut add = |now: f64, change: f64| {
                squared += change * change;
                absolute += change.abs();
                whole += now * now;
            };
            let [now, now_tangential] = self.problem.reduced_impulse(number, row);
            add(mass * now, mass * row.shifted_impulse - root * normal);
            if M::FRICTION {
                add(mass * now_tangential, mass * row.tangential_impulse - root * tangential);
            }
        }
        match settings.stop {
            StopTest::ImpulsePerMass => absolute <= tolerance * self.problem.mean_mass,
            _ => squared <= tolerance * tolerance * whole,
        }
    }
}
