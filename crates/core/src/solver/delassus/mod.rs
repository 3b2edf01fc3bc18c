//! A contact problem that is given by the Delassus operator W: u = W r + q, without any bodies.
//!
//! W (1/kg) is the change of the relative velocity of one contact per impulse of another contact. r = (P_n, P_t) are
//! the normal and tangential impulses in N·s, u the relative velocities at the end of the step, and q the relative
//! velocities without contact impulses, restitution term included, in m/s. Rows and columns are ordered as N0, T0, N1,
//! T1, … (N normal, T tangential, with the number of the contact). The contact law is the law of `contact::law`; each
//! contact has its own largest impulse of cohesion c₀ = C₀Δt (cohesion force times time step) and its own friction
//! coefficient μ. The law requires
//!
//! > 0 ≤ p ⟂ u_n ≥ 0,  |P_t| ≤ μp (shifted cone) or ≤ μ max(p − c₀, 0) (compressive), p = P_n + c₀.
//!
//! W is stored as 2×2 blocks in compressed sparse rows; each contact's own block is stored separately. A problem stores
//! (p, P_t) instead of (P_n, P_t): p is the shifted normal impulse, which is never negative because it includes c₀.
//! Cohesion is then part of the free velocity and costs nothing: u = W (p, P_t) + q', q' = q − W (c₀, 0).
//!
//! Gauss–Seidel on W (M. Jean, 1999) solves one contact after the other, each exactly for the present impulses of all
//! other contacts. Methods that treat all impulses as one vector use scaled impulses s = P/√m_n with m_n = 1/W_nn, and
//! the matrix A: W multiplied by √m_n from both sides. If W_nt ≠ 0 (the entry of W that couples normal and tangent of a
//! contact), a contact's own block of A has off-diagonal entries; no method on `ContactSystem` needs them to be zero.

mod local;
mod matrix;

use self::local::LocalBlock;
pub use self::matrix::{Assembled, Triplets};
use self::matrix::{blocks, check_each, check_length, check_symmetry, own_blocks};
use super::method::Method;
use super::methods::{
    ContactSystem, ScaledVector, SolveReport, WorkVectors, solve_system, sweep_until_settled,
};
use super::settings::{SolverSettings, StopTest};
use crate::error::{self, Error, Result};
use crate::number::Parts;
use crate::world::FrictionCone;

/// Limit of the change of the impulses in a sweep, in multiples of the error of the impulses that the tolerance allows:
/// the residual is computed after each sweep whose change is at most this limit, to test whether the tolerance is met.
/// The residual costs as much as a sweep, and the change in a sweep is about as large as the error before that sweep. A
/// smaller limit risks an unnecessary sweep, a larger limit an unnecessary computation of the residual.
const NEAR: f64 = 2.0;
/// Interval, in sweeps, at which the residual is computed while the impulses still change in each sweep by more than
/// [`NEAR`] times the error that the tolerance allows. The residual costs as much as a sweep. With a smaller interval
/// it is computed more often without effect; with a larger interval, a solve that has already reached its tolerance may
/// do up to this number of unnecessary sweeps.
const TEST_INTERVAL: u32 = 16;

/// A 2×2 block of the Delassus operator outside its diagonal, 1/kg: the change of a contact's velocity per impulse of
/// another contact, whose index is `contact`.
#[derive(Clone, Copy, Debug)]
struct DelassusBlock {
    block: [[f64; 2]; 2],
    contact: u32,
}

/// Data of one contact, in the form that the Gauss–Seidel update reads.
#[derive(Clone, Copy, Debug)]
struct DelassusRow {
    local: LocalBlock,
    /// Velocity q' of the contact if the shifted normal impulses (normal impulse plus the largest impulse of cohesion,
    /// so that they are never negative) and the tangential impulses of all contacts are 0, m/s. So the effect of the
    /// cohesion impulses is a part of q'.
    free: [f64; 2],
    /// Index of the contact's first block in `DelassusProblem::neighbours`. Its blocks end where the blocks of the next
    /// contact begin.
    start: u32,
}

/// A contact problem that is given by the Delassus operator W, with the impulses of its contacts.
#[derive(Clone, Debug)]
pub struct DelassusProblem {
    rows: Vec<DelassusRow>,
    neighbours: Vec<DelassusBlock>,
    /// Shifted normal impulse (normal impulse plus the largest impulse of cohesion, so that it is never negative) and
    /// tangential impulse of each contact, N·s.
    impulses: Vec<[f64; 2]>,
    compressive_cone: bool,
    /// Denominator of the residual, ‖(m_n q_n, m_t q_t)‖₂, N·s, with the effective masses m_n and m_t and the
    /// velocities q without contact impulses.
    scale: f64,
}

impl DelassusProblem {
    /// Creates a problem of `friction.len()` contacts with zero impulses from the Delassus operator W (`matrix`, 1/kg).
    /// `free_velocities` is q, the velocities without contact impulses (m/s), two entries per contact. `friction` has
    /// the friction coefficient and `cohesion_impulses` the cohesion impulse C₀Δt (N·s) of each contact.
    ///
    /// # Errors
    /// An error names a value that is not finite, out of range or not symmetric, or an array of the wrong length. Each
    /// contact's own 2×2 block of W must be positive definite.
    pub fn new(
        matrix: &Triplets,
        free_velocities: &[f64],
        friction: &[f64],
        cohesion_impulses: &[f64],
        cone: FrictionCone,
    ) -> Result<Self> {
        let contacts = friction.len();
        error::check(contacts != 0, "nc", 0, "at least 1")?;
        check_length("q", free_velocities.len(), 2 * contacts, "2 nc")?;
        check_length("c0", cohesion_impulses.len(), contacts, "nc")?;
        check_each("q", free_velocities, "a finite number", |q| q.is_finite())?;
        let at_least_zero = |value: f64| value >= 0.0 && value.is_finite();
        check_each("mu", friction, "a finite number ≥ 0", at_least_zero)?;
        check_each("c0", cohesion_impulses, "a finite number ≥ 0", at_least_zero)?;
        let blocks = blocks(matrix, contacts)?;
        let own = own_blocks(&blocks, contacts)?;
        check_symmetry(&blocks, &own)?;

        let mut rows = Vec::with_capacity(contacts);
        let mut neighbours = Vec::with_capacity(blocks.len());
        let mut at = 0;
        for contact in 0..contacts {
            let q = [free_velocities[2 * contact], free_velocities[2 * contact + 1]];
            let (friction, cohesion) = (friction[contact], cohesion_impulses[contact]);
            let local = LocalBlock::new(own[contact], friction, cohesion);
            let mut row = DelassusRow { local, free: q, start: neighbours.len() as u32 };
            while let Some(&([_, other], block)) =
                blocks.get(at).filter(|([here, _], _)| *here as usize == contact)
            {
                at += 1;
                row.free[0] -= block[0][0] * cohesion_impulses[other as usize];
                row.free[1] -= block[1][0] * cohesion_impulses[other as usize];
                if other as usize != contact {
                    neighbours.push(DelassusBlock { block, contact: other });
                }
            }
            rows.push(row);
        }
        let scale = rows.iter().zip(free_velocities.chunks_exact(2));
        let scale: f64 = scale.map(|(row, q)| row.squared_scale([q[0], q[1]])).sum();
        Ok(Self {
            impulses: vec![[0.0; 2]; contacts],
            compressive_cone: cone == FrictionCone::Compressive,
            scale: scale.sqrt(),
            rows,
            neighbours,
        })
    }

    /// Returns the number of contacts.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Returns true if there are no contacts, which never happens because [`Self::new`] refuses such a problem.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Returns the normal and tangential impulses of each contact, N·s, without cohesion impulses.
    pub fn impulses(&self) -> impl ExactSizeIterator<Item = [f64; 2]> {
        self.impulses
            .iter()
            .zip(&self.rows)
            .map(|(impulse, row)| [impulse[0] - row.local.cohesion_impulse, impulse[1]])
    }

    /// Sets the normal and tangential impulses of each contact, N·s, without cohesion impulses. They need not satisfy
    /// the contact law.
    pub fn set_impulses(&mut self, impulses: impl IntoIterator<Item = [f64; 2]>) {
        let places = self.impulses.iter_mut().zip(&self.rows);
        for ((place, row), [normal, tangential]) in places.zip(impulses) {
            *place = [normal + row.local.cohesion_impulse, tangential];
        }
    }

    /// Returns the normal and tangential relative velocity of each contact at the present impulses, m/s.
    pub fn velocities(&self) -> impl ExactSizeIterator<Item = [f64; 2]> {
        (0..self.len()).map(|contact| self.velocity(contact))
    }

    /// Returns the residual (relative size of the natural map), dimensionless, defined as in
    /// [`residual`](crate::solver::residual) for problems with bodies. The effective masses along normal and tangent
    /// are m_n = 1/W_nn and m_t = 1/W_tt, with the entries of the contact's own block of the Delassus operator W. The
    /// velocities after the step and without contact impulses are computed from W and the free velocities q. An entry
    /// W_nt ≠ 0 is allowed: for any positive m_n and m_t the map is zero exactly if the contact law is satisfied. If
    /// the friction coefficient is 0, the tangential part of a contact does not enter the denominator.
    pub fn residual(&self) -> f64 {
        let errors = self.rows.iter().enumerate().map(|(contact, row)| {
            row.squared_error(self.impulses[contact], self.velocity(contact), self.compressive_cone)
        });
        let error = errors.sum::<f64>().sqrt();
        if error > 0.0 { error / self.scale } else { error }
    }

    #[inline(always)]
    fn velocity(&self, contact: usize) -> [f64; 2] {
        let row = &self.rows[contact];
        let mut velocity = self.velocity_of_others(contact);
        let [normal, tangential] = self.impulses[contact];
        velocity[0] += row.local.normal * normal + row.local.mixed * tangential;
        velocity[1] += row.local.mixed * normal + row.local.tangential * tangential;
        velocity
    }

    #[inline(always)]
    fn neighbours_of(&self, contact: usize) -> &[DelassusBlock] {
        let start = self.rows[contact].start as usize;
        let end =
            self.rows.get(contact + 1).map_or(self.neighbours.len(), |row| row.start as usize);
        &self.neighbours[start..end]
    }

    /// Returns the normal and tangential velocity, m/s, of contact number `contact` due to its free velocity and the
    /// present impulses of all other contacts, without the effect of its own impulses.
    #[inline(always)]
    fn velocity_of_others(&self, contact: usize) -> [f64; 2] {
        let mut velocity = self.rows[contact].free;
        for DelassusBlock { block, contact: other } in self.neighbours_of(contact) {
            let [normal, tangential] = self.impulses[*other as usize];
            velocity[0] += block[0][0] * normal + block[0][1] * tangential;
            velocity[1] += block[1][0] * normal + block[1][1] * tangential;
        }
        velocity
    }
}

impl DelassusRow {
    /// Returns the contact's part of the squared natural map, (N·s)²: the sum of the squared errors of the shifted
    /// normal impulse `p` (normal impulse plus the largest impulse of cohesion, so that it is never negative) and the
    /// tangential impulse `rubbing` (N·s) at the relative velocity `u` (m/s). For each impulse, the impulse minus
    /// effective mass times velocity is limited to the range that the contact law allows; the error is the difference
    /// between the impulse and this value. If `compressive` is true, the cohesion impulse does not count in the
    /// friction bound.
    fn squared_error(&self, [p, rubbing]: [f64; 2], u: [f64; 2], compressive: bool) -> f64 {
        let LocalBlock { normal, tangential, friction, cohesion_impulse, .. } = self.local;
        let rubs =
            if compressive { (p - cohesion_impulse).positive_part() } else { p.positive_part() };
        let bound = friction * rubs;
        // If an impulse has overflowed and the friction coefficient is 0, the bound is NaN, and so is the error.
        if bound.is_nan() {
            return f64::NAN;
        }
        let normal_error = p - (p - u[0] / normal).positive_part();
        let tangential_error = rubbing - (rubbing - u[1] / tangential).clamp(-bound, bound);
        normal_error * normal_error + tangential_error * tangential_error
    }

    /// Returns the contact's contribution (m_n q_n)² + (m_t q_t)² to the squared denominator of the residual, (N·s)²,
    /// with the effective masses m_n and m_t along normal and tangent, and the velocity q without contact impulses. The
    /// tangential term is left out if the friction coefficient is 0.
    fn squared_scale(&self, q: [f64; 2]) -> f64 {
        let normal = q[0] / self.local.normal;
        let tangential = if self.local.friction > 0.0 { q[1] / self.local.tangential } else { 0.0 };
        normal * normal + tangential * tangential
    }

    /// Returns the factor √W_nn of the scaled variables, kg^−½, with W_nn the change of the contact's normal velocity
    /// per normal impulse, 1/kg. A scaled impulse is the impulse times this factor, and a scaled velocity is the
    /// velocity divided by it.
    #[inline(always)]
    fn root(&self) -> f64 {
        self.local.normal.sqrt()
    }
}

/// Solves a problem with the method of the settings, from the problem's present impulses, until the residual is at most
/// the tolerance of the settings.
///
/// # Errors
/// Returns an error if the settings are not valid, have another stopping test than the residual, or name a method that
/// needs data on the bodies, such as their masses.
pub fn solve_delassus(
    problem: &mut DelassusProblem,
    settings: &SolverSettings,
) -> Result<SolveReport> {
    settings.validate()?;
    if settings.stop != StopTest::Residual {
        let allowed = "residual where there are no bodies";
        return Err(Error::value("stop", format!("{:?}", settings.stop), allowed));
    }
    if settings.method == Method::Nsgs {
        return Ok(sweeps(problem, settings));
    }
    solve_system(problem, settings, &mut WorkVectors::default()).ok_or_else(|| {
        let allowed = "one that works on W alone, for the problem says nothing of its bodies";
        Error::value("method", settings.method.name(), allowed)
    })
}

fn sweeps(problem: &mut DelassusProblem, settings: &SolverSettings) -> SolveReport {
    let near = NEAR * settings.tolerance * problem.scale;
    let sweep = |problem: &mut DelassusProblem, sweeps: u32| {
        let squared_change = problem.pass();
        let is_tested = squared_change <= near * near
            || sweeps.is_multiple_of(TEST_INTERVAL)
            || sweeps == settings.max_sweeps;
        is_tested && problem.residual() <= settings.tolerance
    };
    sweep_until_settled(problem, settings, sweep, |problem| problem.residual())
}

impl DelassusProblem {
    /// Performs one Gauss–Seidel sweep over all contacts. Returns the sum of the squared changes of all impulses,
    /// (N·s)².
    fn pass(&mut self) -> f64 {
        let mut squared_change = 0.0;
        for contact in 0..self.len() {
            let free = self.velocity_of_others(contact);
            let now = self.rows[contact].local.solve(free, self.compressive_cone);
            let before = std::mem::replace(&mut self.impulses[contact], now);
            let change = [now[0] - before[0], now[1] - before[1]];
            squared_change += change[0] * change[0] + change[1] * change[1];
        }
        squared_change
    }
}

impl ContactSystem for DelassusProblem {
    const FRICTION: bool = true;

    fn len(&self) -> usize {
        self.rows.len()
    }

    fn read(&self, impulses: &mut ScaledVector) {
        impulses.clear();
        impulses.extend(self.rows.iter().zip(&self.impulses).map(|(row, impulse)| {
            let root = row.root();
            impulse.map(|impulse| root * impulse)
        }));
    }

    fn write(&mut self, impulses: &[[f64; 2]]) {
        for ((row, place), impulse) in self.rows.iter().zip(&mut self.impulses).zip(impulses) {
            let root = row.root();
            *place = impulse.map(|impulse| impulse / root);
        }
    }

    fn velocities(&self, velocities: &mut ScaledVector) {
        velocities.clear();
        velocities.extend((0..self.rows.len()).map(|contact| {
            let root = self.rows[contact].root();
            self.velocity(contact).map(|velocity| velocity / root)
        }));
    }

    #[inline(always)]
    fn tangential_diagonal(&self, contact: usize) -> f64 {
        let local = &self.rows[contact].local;
        local.tangential / local.normal
    }

    #[inline(always)]
    fn friction(&self, contact: usize) -> f64 {
        self.rows[contact].local.friction
    }

    #[inline(always)]
    fn friction_bound(&self, contact: usize, normal: f64) -> f64 {
        let row = &self.rows[contact];
        let shift =
            if self.compressive_cone { row.root() * row.local.cohesion_impulse } else { 0.0 };
        row.local.friction * (normal - shift).positive_part()
    }

    /// Computes the weight d of each contact, dimensionless, for which E/d is an upper bound of the scaled Delassus
    /// operator A (E/d − A has no negative eigenvalue), where E is the diagonal of A. By Gershgorin's theorem the sums
    /// of the absolute entries in the rows of E^−½ A E^−½ bound this matrix, so 1/d is the larger sum of the contact's
    /// two rows.
    fn splitting(&self, weights: &mut Vec<f64>) {
        weights.clear();
        let diagonal = |contact: usize| {
            let local = &self.rows[contact].local;
            [local.normal, local.tangential]
        };
        for contact in 0..self.rows.len() {
            let own = diagonal(contact);
            let off = self.rows[contact].local.mixed.abs() / (own[0] * own[1]).sqrt();
            let mut sums = [1.0 + off; 2];
            for DelassusBlock { block, contact: other } in self.neighbours_of(contact) {
                let others = diagonal(*other as usize);
                for (sum, (entries, own)) in sums.iter_mut().zip(block.iter().zip(own)) {
                    for (entry, other) in entries.iter().zip(others) {
                        *sum += entry.abs() / (own * other).sqrt();
                    }
                }
            }
            weights.push(1.0 / sums[0].max(sums[1]));
        }
    }

    fn sweep(&mut self) {
        self.pass();
    }

    fn tested_sweep(&mut self, settings: &SolverSettings) -> bool {
        self.pass();
        self.is_settled(&[], settings)
    }

    fn residual(&self) -> f64 {
        Self::residual(self)
    }

    /// Returns true if the residual is at most the tolerance: without bodies the stopping test is always the residual.
    fn is_settled(&self, _before: &[[f64; 2]], settings: &SolverSettings) -> bool {
        debug_assert_eq!(settings.stop, StopTest::Residual);
        self.residual() <= settings.tolerance
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks that a problem without a solution is reported as stalled, and a similar problem with a solution as
    /// converged. The first problem has two contacts on opposite sides of one body, each closing at 1 m/s. For any
    /// impulses the sum of their two normal velocities is −2 m/s, so the velocities cannot both be ≥ 0.
    #[test]
    fn a_problem_without_solution_is_told_from_one_that_was_stopped_too_early() {
        let matrix = Triplets {
            row: vec![0, 0, 1, 2, 2, 3],
            col: vec![0, 2, 1, 0, 2, 3],
            val: vec![1.0, -1.0, 1.0, -1.0, 1.0, 1.0],
        };
        let free_velocities = [-1.0, 0.0, -1.0, 0.0];
        let settings = SolverSettings {
            max_sweeps: 100_000,
            stop: StopTest::Residual,
            ..SolverSettings::SWEEPS
        };
        let problem = |free: &[f64]| {
            DelassusProblem::new(&matrix, free, &[0.0; 2], &[0.0; 2], FrictionCone::Shifted)
        };
        let mut infeasible = problem(&free_velocities).expect("a valid problem");
        let report = solve_delassus(&mut infeasible, &settings).expect("a method that works on W");
        assert!(report.stalled && !report.converged && report.sweeps < 10_000, "{report:?}");

        let mut feasible = problem(&[-1.0, 0.0, 2.0, 0.0]).expect("a valid problem");
        let report = solve_delassus(&mut feasible, &settings).expect("a method that works on W");
        assert!(report.converged && !report.stalled, "{report:?}");
    }
}
