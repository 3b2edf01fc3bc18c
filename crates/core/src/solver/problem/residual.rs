//! The natural map: the residual that is common to all methods, and those of models of friction.

use super::friction::{FrictionProjection, with_projection};
use super::row_velocities::{RowVelocities, sum_of_rows};
use super::{Row, StepProblem};
use crate::contact::{ContactLaw, Lanes, law};
use crate::solver::kinematics::Model;
use crate::solver::settings::FrictionModel;

/// The natural map's residual in impulse units. A contact's impulses solve its law exactly where
/// they are the projections that a Gauss–Seidel update would make of them, so with
/// p = P_n + C₀Δt
///
/// > e_n = p − max(0, p − m_n (v_n + ρ v_n^{n−1})),  e_t = P_t − clamp(P_t − m_t v_t, ±bound(p)),
///
/// > residual = ‖(e_n, e_t)‖₂ / ‖(m_n v_n^free, m_t v_t^free)‖₂,
///
/// with v^free the relative velocity without any contact impulse, restitution's term included. It
/// is 0 where nothing moves and nothing errs beyond rounding, and infinite where nothing would move and
/// something errs. Rows hold p/m_n and P_t/m_n, so each row's terms are
/// formed in m/s and weighted by m_n.
#[inline(never)]
pub fn residual<M: Model>(problem: &StepProblem<M>) -> f64 {
    common_map(problem).residual::<M>(problem)
}

/// What [`residual`] is made of.
fn common_map<M: Model>(problem: &StepProblem<M>) -> Sums {
    let add_error = |sums: &mut Sums, (number, row): (usize, &Row<_>), motion: RowVelocities| {
        sums.add_error(problem, number, row, &motion);
    };
    sum_of_rows(problem, add_error, Sums::add_all)
}

/// The same of the model of friction that a problem is solved by: the natural map of its projection
/// (`problem::friction`), over the same scale, so that both can be set side by side.
fn projection_map<M: Model, P: FrictionProjection>(problem: &StepProblem<M>) -> Sums {
    let compliance = 1.0 / M::TANGENTIAL_COMPLIANCE;
    let add_error = |sums: &mut Sums, (number, row): (usize, &Row<_>), motion: RowVelocities| {
        let now = problem.own_part(number, row, motion.now).unwrap_or(motion.now);
        let opening = now[0] + row.restitution_velocity;
        let [normal, tangential] = row.impulse();
        let trial = [normal - opening, tangential - compliance * now[1]];
        let allowed = P::project::<M>(&problem.law, problem.friction.now[number], trial);
        sums.add::<M>(row, [normal - allowed[0], tangential - allowed[1]], &motion);
    };
    sum_of_rows(problem, add_error, Sums::add_all)
}

/// The natural map of a projection: that of Coulomb's law, or of the model of friction.
fn map_of<M: Model, P: FrictionProjection>(problem: &StepProblem<M>) -> Sums {
    if P::LAGS { projection_map::<M, P>(problem) } else { common_map(problem) }
}

/// The natural map's residual of a projection.
pub(crate) fn projection_residual<M: Model, P: FrictionProjection>(
    problem: &StepProblem<M>,
) -> f64 {
    map_of::<M, P>(problem).residual(problem)
}

/// The natural map of what a problem is solved for: of its model of friction, or the common one.
pub(super) fn natural_map_sums<M: Model>(problem: &StepProblem<M>) -> Sums {
    with_projection!(problem, M, P => map_of::<M, P>(problem))
}

/// The residual of [`natural_map_sums`], dimensionless.
pub(crate) fn natural_map<M: Model>(problem: &StepProblem<M>) -> f64 {
    natural_map_sums(problem).residual(problem)
}

/// (e_n, e_t) of [`residual`] over the effective masses, m/s, of contacts with these (σ, λ_t) and (v_n, v_t).
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

/// The square of the scale of [`residual`], which is the same during a whole solve.
pub(crate) fn squared_residual_scale<M: Model>(problem: &StepProblem<M>) -> f64 {
    let add_scale = |sums: &mut Sums, (_, row): (usize, &Row<_>), motion: RowVelocities| {
        sums.add_scale::<M>(row, motion.free);
    };
    sum_of_rows(problem, add_scale, Sums::add_all).scale
}

/// [`residual`] from the squares of its error and scale.
pub(crate) fn residual_of<M: Model>(
    problem: &StepProblem<M>,
    [squared_error, squared_scale]: [f64; 2],
) -> f64 {
    Sums { error: squared_error, scale: squared_scale }.residual::<M>(problem)
}

/// The squares of a residual's error and scale.
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
        let errors = errors::<M, f64>(&problem.law, row.impulse(), row.restitution_velocity, now);
        self.add::<M>(row, errors, motion);
    }

    /// Adds the errors (e_n, e_t) of a row, m/s.
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

    /// Adds what a row would do if no contact acted, by its free (v_n, v_t), m/s.
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

/// Where nothing would move without contacts, errors of up to this share of the impulses are what
/// rounding left, and no residual. Smaller: methods that scale impulses would not have solved a step in
/// which nothing happens; larger: errors would go unseen.
pub(super) const ROUNDING: f64 = 1e-14;

/// What that leaves of errors, N·s.
pub(super) fn rounding<M: Model>(problem: &StepProblem<M>) -> f64 {
    let squared = |row: &Row<M>| squared_impulse(row.effective_mass, row.impulse());
    ROUNDING * problem.rows.iter().map(squared).sum::<f64>().sqrt()
}

/// P² of an impulse (λ_n, λ_t) of an effective mass, (N·s)².
#[inline(always)]
pub(crate) fn squared_impulse(mass: f64, [normal, tangential]: [f64; 2]) -> f64 {
    mass * mass * (normal * normal + tangential * tangential)
}
