//! A contact problem whose impulses form one vector, for methods that update all contacts at once.
//!
//! **Scaled variables.** A contact has the effective masses m_n and m_t along its normal and tangent, kg, the shifted
//! normal impulse p = P_n + C₀Δt (normal impulse plus cohesion force times time step, which is the largest impulse of
//! cohesion, so that p is never negative, N·s), the tangential impulse P_t, N·s, the tangential velocity v_t, m/s, and
//! the normal velocity plus the restitution term, u_n = v_n + ρ v_n^{n−1}, m/s (restitution ρ times v_n^{n−1}, the
//! normal velocity before the step). A step's problem is to find impulses, and velocities that are affine in the
//! impulses, with
//!
//! > p = max(0, p − m_n u_n),  P_t = clamp(P_t − m_t v_t, ±bound(p)),
//!
//! with the largest tangential impulse bound(p) that friction allows. Impulses divided by √m_n are the scaled impulses
//! s = (p, P_t)/√m_n, and velocities multiplied by √m_n are the scaled velocities w = √m_n·(u_n, v_t). Both have the
//! unit √J, the root of joule. The map w(s) = A s + b, with the scaled velocities b without impulses, has a *symmetric*
//! positive semi-definite matrix A (the Delassus operator multiplied by √m_n from both sides). Its diagonal is 1 in
//! every normal entry and m_n/m_t in every tangential entry. The conditions become
//!
//! > s_n = max(0, s_n − w_n),  s_t = clamp(s_t − w_t m_t/m_n, ±bound(s_n)).
//!
//! A method that is written for the trait `ContactSystem` needs no access to the bodies.

use super::pass::{sweep, tested_sweep};
use super::stopping::{SolveReport, StallWatch};
use crate::contact::law;
use crate::solver::kinematics::Model;
use crate::solver::problem::{ContactRows, Row, StepProblem, is_solved, residual};
use crate::solver::settings::{SolverSettings, StopTest};
use crate::world::FrictionCone;

/// Scaled impulses or velocities of all contacts: two numbers (normal, tangential) per contact, in √J. The scale is the
/// root √m_n of a contact's effective mass: impulses are divided by it, velocities multiplied. In a vector of impulses,
/// contacts that resist rolling have a further entry (√m_n ψ, 0) at the end, with ψ the reduced rolling impulse, m/s
/// (`problem::rolling`).
pub type ScaledVector = Vec<[f64; 2]>;

/// Work memory of methods on a [`ContactSystem`]. The memory is reused for the next solve, which overwrites its
/// contents.
#[derive(Debug, Default)]
pub(crate) struct WorkVectors {
    /// Vectors of scaled impulses or velocities for intermediate results, as many as any method needs.
    pub pairs: [ScaledVector; 8],
    /// One dimensionless weight per contact, computed by [`ContactSystem::splitting`]: the weights limit the step
    /// lengths with which all contacts can be updated at once without divergence.
    pub weights: Vec<f64>,
}

impl Clone for WorkVectors {
    /// Returns empty vectors instead of a copy, because the contents are not needed after a solve.
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// The contact problem of one step in scaled variables, which have the unit √J. The scaled impulses of a contact are
/// its normal impulse plus cohesion impulse and its tangential impulse (N·s), divided by the root of its effective mass
/// (kg). The scaled velocities are its normal velocity plus the restitution term (restitution times the normal velocity
/// before the step), and its tangential velocity (m/s), multiplied by that root. The scaled velocities are an affine
/// function of the scaled impulses, whose matrix is called A. The argument `contact` of a function is an index below
/// [`ContactSystem::len`].
pub trait ContactSystem {
    /// True if contacts have tangential impulses. If not, tangential entries are 0.
    const FRICTION: bool;

    /// Returns the number of contacts.
    fn len(&self) -> usize;

    /// Returns true if there are no contacts.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Copies the present scaled impulses of all contacts (impulses divided by the root of the effective mass, √J) to
    /// `impulses`, which is cleared first.
    fn read(&self, impulses: &mut ScaledVector);

    /// Sets the scaled impulses of all contacts (impulses divided by the root of the effective mass, √J), which may
    /// have any sign and size, and computes the velocities that follow from them.
    fn write(&mut self, impulses: &[[f64; 2]]);

    /// Copies the present scaled velocities of all contacts (velocities times the root of the effective mass, √J) to
    /// `velocities`, which is cleared first.
    fn velocities(&self, velocities: &mut ScaledVector);

    /// Returns the ratio m_n/m_t of a contact's effective masses along normal and tangent, dimensionless. It is the
    /// tangential entry on the diagonal of the matrix A that maps scaled impulses to scaled velocities; the normal
    /// entry is 1.
    fn tangential_diagonal(&self, contact: usize) -> f64;

    /// Returns the friction coefficient μ of a contact, dimensionless.
    fn friction(&self, contact: usize) -> f64;

    /// Returns the largest tangential impulse that friction allows at a contact whose normal impulse plus cohesion
    /// impulse is `normal` ≥ 0. Both are scaled impulses (impulses divided by the root of the effective mass, √J).
    fn friction_bound(&self, contact: usize, normal: f64) -> f64;

    /// Computes a dimensionless weight d > 0 per contact. Let A be the matrix that maps scaled impulses s (impulses
    /// divided by the root of the effective mass) to scaled velocities w (velocities times this root), and D the
    /// diagonal matrix with the entries d (normal) and d m_t/m_n (tangential) of each contact, with the effective
    /// masses m_n and m_t along normal and tangent. The weights are such that D⁻¹ − A is positive semi-definite. So a
    /// projected gradient step s − D w for all contacts at once cannot diverge. Clears `weights` first.
    fn splitting(&self, weights: &mut Vec<f64>);

    /// Performs one Gauss–Seidel sweep from the present impulses. The resulting impulses satisfy the bounds of the
    /// contact law.
    fn sweep(&mut self);

    /// Performs one Gauss–Seidel sweep. Returns true if the stopping test of the settings is met after the sweep.
    fn tested_sweep(&mut self, settings: &SolverSettings) -> bool;

    /// Returns the residual of the present impulses under Coulomb's law, dimensionless.
    fn residual(&self) -> f64;

    /// Returns true if the stopping test of the settings is met after an iteration that changed the scaled impulses
    /// from `before` to the present impulses.
    fn is_settled(&self, before: &[[f64; 2]], settings: &SolverSettings) -> bool;
}

/// The contact problem of a step, accessed in scaled variables: impulses divided by the root of the contact's effective
/// mass, and velocities times this root. Impulses change the velocities of bodies; the matrix that maps impulses to
/// contact velocities is never computed.
#[derive(Debug)]
pub struct BodySystem<'a, M: Model> {
    problem: &'a mut StepProblem<M>,
}

impl<'a, M: Model> BodySystem<'a, M> {
    /// Creates the system of a contact problem. Its contacts are numbered in the order in which the problem stores
    /// them: contacts with fixed bodies first, then contacts between grains.
    pub fn new(problem: &'a mut StepProblem<M>) -> Self {
        let StepProblem { rows, root_masses, .. } = &mut *problem;
        root_masses.clear();
        root_masses.extend(rows.iter().map(|row| row.effective_mass.sqrt()));
        Self { problem }
    }

    /// Returns the root √m_n of a contact's effective mass, kg^½: the factor between a scaled impulse s, √J, and the
    /// impulse P = √m_n s, N·s.
    pub fn root_mass(&self, contact: usize) -> f64 {
        self.problem.root_masses[contact]
    }

    /// Iterates over the rows (the data of the contacts), each with the root of the contact's effective mass, kg^½.
    fn rows(&self) -> impl Iterator<Item = (&Row<M>, &f64)> {
        self.problem.rows.iter().zip(&self.problem.root_masses)
    }
}

impl<M: Model> ContactSystem for BodySystem<'_, M> {
    const FRICTION: bool = M::FRICTION;

    fn len(&self) -> usize {
        self.problem.root_masses.len()
    }

    fn read(&self, impulses: &mut ScaledVector) {
        impulses.clear();
        impulses.extend(
            self.rows()
                .map(|(row, root)| [root * row.shifted_impulse, root * row.tangential_impulse]),
        );
        let rolling = self.problem.rows.rolling.iter().zip(&self.problem.root_masses);
        impulses.extend(rolling.map(|(rolling, root)| [root * rolling.impulse, 0.0]));
    }

    fn write(&mut self, impulses: &[[f64; 2]]) {
        let StepProblem { rows, root_masses, .. } = &mut *self.problem;
        let of_rows = rows.iter_mut().zip(&*root_masses).zip(impulses);
        for ((row, root), [normal, tangential]) in of_rows {
            row.shifted_impulse = normal / *root;
            if M::FRICTION {
                row.tangential_impulse = tangential / *root;
            }
        }
        let further = impulses.get(root_masses.len()..).unwrap_or_default();
        for ((rolling, root), [impulse, _]) in rows.rolling.iter_mut().zip(root_masses).zip(further)
        {
            rolling.impulse = impulse / *root;
        }
        self.problem.form_velocities();
    }

    fn velocities(&self, velocities: &mut ScaledVector) {
        velocities.clear();
        let mut roots = self.problem.root_masses.iter();
        self.problem.for_each_velocity(&self.problem.bodies.now, |row, [normal, tangential]| {
            let Some(root) = roots.next() else { return };
            let tangential = if M::FRICTION { root * tangential } else { 0.0 };
            velocities.push([root * (normal + row.restitution_velocity), tangential]);
        });
    }

    #[inline(always)]
    fn tangential_diagonal(&self, _contact: usize) -> f64 {
        M::TANGENTIAL_COMPLIANCE
    }

    #[inline(always)]
    fn friction(&self, contact: usize) -> f64 {
        self.problem.law_of(contact).friction
    }

    #[inline(always)]
    fn friction_bound(&self, contact: usize, normal: f64) -> f64 {
        let law = self.problem.law_of(contact);
        match law.cone() {
            FrictionCone::Shifted => law.friction_bound(normal),
            FrictionCone::Compressive => {
                let root = self.problem.root_masses[contact];
                root * law.friction_bound(normal / root)
            }
        }
    }

    /// Computes the weights d of the diagonal matrix D with A ⪯ D⁻¹ (D⁻¹ − A is positive semi-definite), where A maps
    /// scaled impulses to scaled velocities. The weights follow from mass splitting (R. Tonge, F. Benevolenski, A.
    /// Voroshilov 2012): a body with k contacts is cut into k parts of 1/k of its mass and inertia, one per contact. By
    /// the Cauchy–Schwarz inequality the separate parts respond to impulses at least as much as the body does, so D⁻¹,
    /// the response of the parts, is the required bound of A. For a contact between the grains i and j, which have k_i
    /// and k_j contacts, the inverse mass 1/m_i becomes k_i/m_i. So with the mass ratio g_i = m_ij/m_i (effective mass
    /// divided by the mass of grain i)
    ///
    /// > 1/d = k_i g_i + k_j (1 − g_i), or 1/d = k_i against a fixed body,
    ///
    /// and 1/d = k_i + K κ (b_n² + b_t² m_t/m_n) against a wall that is driven by a force and has K contacts. Here κ is
    /// the ratio of the grain's mass to the effective mass of the wall (mass plus damping coefficient times time step),
    /// b_n and b_t are the components of the wall's direction of motion along normal and tangent (`problem::walls`),
    /// and m_n and m_t are the effective masses along them.
    fn splitting(&self, weights: &mut Vec<f64>) {
        let ContactRows { fixed, pairs, .. } = &self.problem.rows;
        // The first entries of `weights` temporarily contain the number of contacts of each body.
        let count = self.problem.bodies.now.len();
        weights.clear();
        weights.resize(count, 0.0);
        for row in fixed {
            weights[row.i as usize] += 1.0;
        }
        for row in pairs {
            weights[row.i as usize] += 1.0;
            weights[row.j as usize] += 1.0;
        }
        for (row, of_wall) in fixed.iter().zip(self.problem.wall_compliances()) {
            weights.push(1.0 / (weights[row.i as usize] + of_wall.unwrap_or(0.0)));
        }
        for row in pairs {
            let (i, j) = (weights[row.i as usize], weights[row.j as usize]);
            weights.push(1.0 / (row.share * i + (1.0 - row.share) * j));
        }
        weights.drain(..count);
    }

    fn sweep(&mut self) {
        sweep::<M, false>(self.problem);
    }

    fn tested_sweep(&mut self, settings: &SolverSettings) -> bool {
        tested_sweep(self.problem, settings)
    }

    fn residual(&self) -> f64 {
        residual(self.problem)
    }

    fn is_settled(&self, before: &[[f64; 2]], settings: &SolverSettings) -> bool {
        if settings.stop.judges_solutions() {
            return is_solved(self.problem, settings);
        }
        let tolerance = settings.tolerance;
        // Sums over all contacts of impulses in N·s, without the cohesion impulse.
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
        let rests = match settings.stop {
            StopTest::ImpulsePerMass => absolute <= tolerance * self.problem.bodies.mean_mass,
            _ => squared <= tolerance * tolerance * whole,
        };
        // Impulses may stop changing for a while although the problem is not solved.
        rests && is_solved(self.problem, settings)
    }
}

/// Number of iterations between two computations of the residual that are made independently of the stopping test. They
/// find the impulses with the smallest residual so far, and whether the solve has stalled. A shorter interval costs
/// more. A solve that fails returns the best impulses found in this way; with a longer interval it may miss better
/// impulses.
const LOOK_INTERVAL: u32 = 16;

/// Returns trial impulses, which are impulses that may violate the contact law, projected on the law: the nearest
/// allowed normal impulse, and the nearest tangential impulse that this normal impulse allows. All impulses are divided
/// by the root of the effective mass, √J.
#[inline(always)]
pub(crate) fn projected<S: ContactSystem>(
    system: &S,
    contact: usize,
    [normal, tangential]: [f64; 2],
) -> [f64; 2] {
    let normal = law::signorini(normal);
    if !S::FRICTION {
        return [normal, 0.0];
    }
    [normal, law::coulomb(tangential, system.friction_bound(contact, normal))]
}

/// Returns the scalar product Σ a·b of two scaled vectors, computed as four partial sums that the processor can compute
/// at the same time.
pub(crate) fn dot(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
    let mut sums = [0.0; 4];
    let (mut pairs_of_a, mut pairs_of_b) = (a.chunks_exact(2), b.chunks_exact(2));
    for (a, b) in (&mut pairs_of_a).zip(&mut pairs_of_b) {
        sums[0] += a[0][0] * b[0][0];
        sums[1] += a[0][1] * b[0][1];
        sums[2] += a[1][0] * b[1][0];
        sums[3] += a[1][1] * b[1][1];
    }
    for (a, b) in pairs_of_a.remainder().iter().zip(pairs_of_b.remainder()) {
        sums[0] += a[0] * b[0];
        sums[1] += a[1] * b[1];
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}

/// The impulses that gave the smallest residual of a solve so far (impulses divided by the root of the effective mass,
/// √J), and the history of the residual.
pub(crate) struct BestIterate<'a> {
    impulses: &'a mut ScaledVector,
    residual: f64,
    watch: StallWatch,
}

impl<'a> BestIterate<'a> {
    /// Records the present impulses of a system as the impulses with the smallest residual so far.
    pub(crate) fn new<S: ContactSystem>(system: &S, impulses: &'a mut ScaledVector) -> Self {
        system.read(impulses);
        Self { impulses, residual: system.residual(), watch: StallWatch::default() }
    }

    /// Every [`LOOK_INTERVAL`] iterations, computes the residual of the present impulses of the system, which are given
    /// as `impulses`, and records them if their residual is the smallest so far. `sweeps` is the number of iterations
    /// so far. Returns true if the solve should stop because its residual no longer decreases (it has stalled), or
    /// because an onlooker (a callback that watches the progress) ends it.
    pub(crate) fn look<S: ContactSystem>(
        &mut self,
        system: &S,
        impulses: &[[f64; 2]],
        sweeps: u32,
        settings: &SolverSettings,
    ) -> bool {
        if !sweeps.is_multiple_of(LOOK_INTERVAL) {
            return false;
        }
        let residual = system.residual();
        if residual < self.residual {
            self.residual = residual;
            self.impulses.clear();
            self.impulses.extend_from_slice(impulses);
        }
        self.watch.look(sweeps, settings, || self.residual)
    }

    /// Ends a solve that failed: sets the system's impulses to the impulses with the smallest residual, which may be
    /// the present impulses. Returns the report of the solve.
    pub(crate) fn restore<S: ContactSystem>(self, system: &mut S, sweeps: u32) -> SolveReport {
        let residual = system.residual();
        // NaN compares false, so a residual of NaN counts as worse.
        let present_is_best = residual <= self.residual;
        if !present_is_best {
            system.write(self.impulses);
        }
        let best = if present_is_best { residual } else { self.residual };
        let stalled = self.watch.has_stalled(sweeps, best);
        SolveReport { sweeps, stalled, ..SolveReport::default() }
    }
}
