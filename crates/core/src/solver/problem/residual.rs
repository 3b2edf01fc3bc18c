//! The residual, the measure of error that all methods share, and the residuals of the convex friction models. Each is
//! the relative size of the *natural map* of a contact problem: the change that a Gauss–Seidel update of every contact
//! would make to the present impulses, divided by a norm of impulses.

use super::friction::{FrictionProjection, with_projection};
use super::row_velocities::{RowVelocities, sum_of_rows};
use super::{Row, StepProblem};
use crate::contact::{ContactLaw, Lanes, law};
use crate::solver::kinematics::Model;
use crate::solver::settings::FrictionModel;

/// Returns the residual of a problem under Coulomb's law, dimensionless: the norm of the natural map (the change that a
/// Gauss–Seidel update of every contact would make to the impulses), divided by the norm of the impulses that would
/// stop the motion of every contact by itself. A contact's impulses satisfy its law exactly if a Gauss–Seidel update,
/// which projects them, would not change them. With the normal and tangential impulses P_n and P_t (N·s), the cohesion
/// impulse C₀Δt (cohesion force times time step) and p = P_n + C₀Δt, the normal and tangential errors e_n and e_t of a
/// contact are
///
/// > e_n = p − max(0, p − m_n (v_n + ρ v_n^{n−1})),  e_t = P_t − clamp(P_t − m_t v_t, ±bound(p)),
///
/// > residual = ‖(e_n, e_t)‖₂ / ‖(m_n v_n^free, m_t v_t^free)‖₂,
///
/// with v_n and v_t the relative velocities after the step, v_n^{n−1} the normal velocity before the step, ρ the
/// restitution, bound(p) the largest friction impulse, v^free the relative velocity without any contact impulse,
/// including the restitution term, and m_n and m_t (kg) the effective masses of a contact along normal and tangent. If
/// the denominator is 0 because no contact moves without contact impulses, the residual is 0 if the error is only
/// rounding, and infinite otherwise. The problem stores p/m_n and P_t/m_n, so the terms of each contact are computed in
/// m/s and weighted by m_n. Rolling moments add their own errors (`problem::rolling`).
#[inline(never)]
pub fn residual<M: Model>(problem: &StepProblem<M>) -> f64 {
    common_map(problem).residual::<M>(problem)
}

/// Computes the squared numerator and denominator, (N·s)², of [`residual`], the relative error of the impulses under
/// Coulomb's law, as sums over all contacts.
fn common_map<M: Model>(problem: &StepProblem<M>) -> Sums {
    let add_error = |sums: &mut Sums, (number, row): (usize, &Row<_>), motion: RowVelocities| {
        sums.add_error(problem, number, row, &motion);
    };
    sum_of_rows(problem, add_error, Sums::add_all)
}

/// Computes the squared numerator and denominator, (N·s)², of the residual under the convex friction model that a
/// problem is solved under (`problem::friction`). The denominator is the denominator of [`residual`], so that both
/// residuals can be compared.
fn projection_map<M: Model, P: FrictionProjection>(problem: &StepProblem<M>) -> Sums {
    let compliance = 1.0 / M::TANGENTIAL_COMPLIANCE;
    let add_error = |sums: &mut Sums, (number, row): (usize, &Row<_>), motion: RowVelocities| {
        let now = problem.own_part(number, row, motion.now).unwrap_or(motion.now);
        let opening = now[0] + row.restitution_velocity;
        let [normal, tangential] = row.impulse();
        let trial = [normal - opening, tangential - compliance * now[1]];
        let law = problem.law_of(number);
        let allowed = P::project::<M>(&law, problem.friction.now[number], trial);
        sums.add::<M>(row, [normal - allowed[0], tangential - allowed[1]], &motion);
    };
    sum_of_rows(problem, add_error, Sums::add_all)
}

/// Computes the squared numerator and denominator, (N·s)², of the residual under the friction model of `P`, the
/// projection of impulses onto the impulses that the model allows. The model may be Coulomb's law.
fn map_of<M: Model, P: FrictionProjection>(problem: &StepProblem<M>) -> Sums {
    if P::LAGS { projection_map::<M, P>(problem) } else { common_map(problem) }
}

/// Returns the residual under the friction model of `P`, the projection of impulses onto the impulses that the model
/// allows; dimensionless. The model may be Coulomb's law.
pub(crate) fn projection_residual<M: Model, P: FrictionProjection>(
    problem: &StepProblem<M>,
) -> f64 {
    map_of::<M, P>(problem).residual(problem)
}

/// Computes the squared numerator and denominator, (N·s)², of the residual under the friction model that a problem is
/// solved under, which may be Coulomb's law.
pub(super) fn natural_map_sums<M: Model>(problem: &StepProblem<M>) -> Sums {
    with_projection!(problem, M, P => map_of::<M, P>(problem))
}

/// Returns the residual of the friction model that a problem is solved under, dimensionless.
pub(crate) fn natural_map<M: Model>(problem: &StepProblem<M>) -> f64 {
    natural_map_sums(problem).residual(problem)
}

/// Returns the normal and tangential errors of contacts, divided by the effective masses, m/s: the differences between
/// the present impulses and the impulses that an update of each contact by its law would give. The arguments, in m/s,
/// are the contacts' shifted normal impulses (normal impulse plus the largest impulse of cohesion, so that they are
/// never negative) and tangential impulses, restitution terms, and normal and tangential relative velocities.
#[inline(always)]
pub(crate) fn errors<M: Model, T: Lanes>(
    law: &ContactLaw,
    [shifted, tangential]: [T; 2],
    restitution_velocity: T,
    [normal_velocity, tangential_velocity]: [T; 2],
) -> [T; 2] {
    let error = shifted - law::signorini(shifted - normal_velocity - restitution_velocity);
    if !M::FRICTION {
        return [error, error.same(0.0)];
    }
    let compliance = shifted.same(1.0 / M::TANGENTIAL_COMPLIANCE);
    let bound = law.friction_bound(shifted);
    [error, tangential - law::coulomb(tangential - compliance * tangential_velocity, bound)]
}

/// Returns the squared denominator of [`residual`], (N·s)²: the sum of the squared impulses that would stop the motion
/// of every contact by itself. It is constant during a solve.
pub(crate) fn squared_residual_scale<M: Model>(problem: &StepProblem<M>) -> f64 {
    let add_scale = |sums: &mut Sums, (_, row): (usize, &Row<_>), motion: RowVelocities| {
        sums.add_scale::<M>(row, motion.free);
    };
    sum_of_rows(problem, add_scale, Sums::add_all).scale
}

/// Computes [`residual`] from its squared numerator and squared denominator, (N·s)².
pub(crate) fn residual_of<M: Model>(
    problem: &StepProblem<M>,
    [squared_error, squared_scale]: [f64; 2],
) -> f64 {
    Sums { error: squared_error, scale: squared_scale }.residual::<M>(problem)
}

/// Squared numerator (`error`) and squared denominator (`scale`) of a residual, (N·s)².
#[derive(Default)]
pub(crate) struct Sums {
    pub(super) error: f64,
    scale: f64,
}

impl Sums {
    pub(super) fn add_all(&mut self, other: Self) {
        self.error += other.error;
        self.scale += other.scale;
    }

    #[inline(always)]
    pub(super) fn add_error<M: Model>(
        &mut self,
        problem: &StepProblem<M>,
        number: usize,
        row: &Row<M>,
        motion: &RowVelocities,
    ) {
        let now = problem.own_part(number, row, motion.now).unwrap_or(motion.now);
        let law = problem.law_of(number);
        let errors = errors::<M, f64>(&law, row.impulse(), row.restitution_velocity, now);
        self.add::<M>(row, errors, motion);
        let squared_mass = row.effective_mass * row.effective_mass;
        if let Some((rolling, velocity)) = problem.rolling(number, row, &problem.bodies.now) {
            let error = rolling.error(&problem.law_of(number), row.shifted_impulse, velocity);
            self.error += squared_mass * error * error;
        }
        if let Some((rolling, velocity)) = problem.rolling(number, row, &problem.bodies.free) {
            let free = velocity / rolling.compliance;
            self.scale += squared_mass * free * free;
        }
    }

    /// Adds a contact's errors to the squared numerator of the residual. The errors, normal and tangential, are the
    /// differences between the present impulses and the impulses that an update by the contact law would give, divided
    /// by the contact's effective mass, m/s. Also adds the contact's contribution to the squared denominator.
    #[inline(always)]
    fn add<M: Model>(
        &mut self,
        row: &Row<M>,
        [error, tangential_error]: [f64; 2],
        motion: &RowVelocities,
    ) {
        let squared_mass = row.effective_mass * row.effective_mass;
        self.error += squared_mass * error * error;
        self.add_scale::<M>(row, motion.free);
        if M::FRICTION {
            self.error += squared_mass * tangential_error * tangential_error;
        }
    }

    /// Adds a contact's contribution to the squared denominator of the residual, from its normal and tangential
    /// relative velocities without contact impulses, m/s.
    #[inline(always)]
    fn add_scale<M: Model>(&mut self, row: &Row<M>, free: [f64; 2]) {
        let squared_mass = row.effective_mass * row.effective_mass;
        let normal = free[0] + row.restitution_velocity;
        self.scale += squared_mass * normal * normal;
        if M::FRICTION {
            let compliance = 1.0 / M::TANGENTIAL_COMPLIANCE;
            let tangential = compliance * free[1];
            self.scale += squared_mass * tangential * tangential;
        }
    }

    pub(super) fn residual<M: Model>(&self, problem: &StepProblem<M>) -> f64 {
        if self.error > 0.0 && self.scale == 0.0 {
            return if self.error.sqrt() <= rounding(problem) { 0.0 } else { f64::INFINITY };
        }
        if self.error > 0.0 { (self.error / self.scale).sqrt() } else { self.error.sqrt() }
    }
}

/// Relative rounding error of impulses. The residual is an error of impulses divided by the impulses that would stop
/// the motion which the contacts would have without contact impulses. If there is no such motion, this quotient is not
/// defined, and errors of at most this fraction of the impulses count as 0. With a smaller value, methods whose
/// unknowns are scaled impulses would not solve a step in which nothing moves, because scaling rounds; with a larger
/// value, real errors would count as 0.
pub(super) const ROUNDING: f64 = 1e-14;

/// Returns the largest numerator of [`residual`] that counts as rounding error if the denominator is 0, N·s.
pub(super) fn rounding<M: Model>(problem: &StepProblem<M>) -> f64 {
    let squared = |row: &Row<M>| squared_impulse(row.effective_mass, row.impulse());
    let squares = problem.rows.iter().map(squared).sum::<f64>();
    ROUNDING * (squares + squared_rolling(problem)).sqrt()
}

/// Returns the sum over the contacts of the squared rolling impulses, Σ (MΔt/R)², (N·s)², with the rolling moment M
/// (N·m), the time step Δt (s), and the reduced radius R (m) from 1/R = 1/r_i + 1/r_j, where r_i and r_j are the radii
/// of the two bodies.
pub(super) fn squared_rolling<M: Model>(problem: &StepProblem<M>) -> f64 {
    let rolling = problem.rows.iter().zip(&problem.rows.rolling);
    rolling.map(|(row, rolling)| (row.effective_mass * rolling.impulse).powi(2)).sum()
}

/// Returns the squared impulse of a contact, (N·s)², from its normal and tangential impulses divided by the effective
/// mass, m/s, and the effective mass `mass`, kg.
#[inline(always)]
pub(crate) fn squared_impulse(mass: f64, [normal, tangential]: [f64; 2]) -> f64 {
    mass * mass * (normal * normal + tangential * tangential)
}
