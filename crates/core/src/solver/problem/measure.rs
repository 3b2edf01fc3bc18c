//! The residual that is common to all methods, and the work of the contact forces.

use super::duality::duality_gap;
use super::held::{Bound, Held, LawNumbers, Opening};
use super::kinematics::Kinematics;
use super::model::Model;
use super::motion::{Motion, ROUNDING, sum_of_rows};
use super::step_problem::{Row, StepProblem};
use crate::contact::{Lanes, law};
use crate::solver::friction_model::FrictionModel;

/// What one pass over the rows tells of a solved step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measures {
    /// The common residual, dimensionless.
    pub residual: f64,
    /// The natural map of the model of friction that was solved, likewise; none under Coulomb's law, whose
    /// it is already.
    pub model_residual: Option<f64>,
    /// The duality gap of that model, dimensionless: its square root bounds the error of the velocities.
    pub duality_gap: Option<f64>,
    /// Contacts with P_n > 0.
    pub compressive_contacts: u32,
    /// Contacts with P_n < 0.
    pub tensile_contacts: u32,
    /// Work of the normal impulses, J.
    pub normal_work: f64,
    /// Work of the tangential impulses, J.
    pub tangential_work: f64,
    /// Of both, the work of surfaces that move, J.
    pub wall_work: f64,
    /// Beside both, what images that slide do to the grains that touch them, J.
    pub border_work: f64,
}

impl Measures {
    /// Tells of a step that was solved under Coulomb's law what is told of others of its run, which were solved
    /// under a model of friction: its common residual, and no bound of the error.
    pub(crate) fn measure_as_a_model(&mut self) {
        self.model_residual = self.model_residual.or(Some(self.residual));
        self.duality_gap = self.duality_gap.or(Some(f64::INFINITY));
    }

    /// Counts other rows of the same problem.
    fn add_rows(&mut self, rows: Self) {
        self.compressive_contacts += rows.compressive_contacts;
        self.tensile_contacts += rows.tensile_contacts;
        self.normal_work += rows.normal_work;
        self.tangential_work += rows.tangential_work;
        self.border_work += rows.border_work;
    }

    /// Counts another piece of the same step; the contacts are those at its end.
    pub fn add(&mut self, piece: Self) {
        let Self { residual, model_residual, duality_gap, .. } = piece;
        let Self { compressive_contacts, tensile_contacts, .. } = piece;
        let Self { normal_work, tangential_work, wall_work, border_work, .. } = piece;
        self.residual = worst(self.residual, residual);
        self.model_residual = worst_of(self.model_residual, model_residual);
        self.duality_gap = worst_of(self.duality_gap, duality_gap);
        self.compressive_contacts = compressive_contacts;
        self.tensile_contacts = tensile_contacts;
        self.normal_work += normal_work;
        self.tangential_work += tangential_work;
        self.wall_work += wall_work;
        self.border_work += border_work;
    }
}

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
pub fn residual<M: Model>(problem: &StepProblem<M::Kinematics>) -> f64 {
    let add_error = |sums: &mut Sums, row: (usize, &Row<_>), motion: Motion| {
        sums.add_error::<M>(problem, row, &motion);
    };
    sum_of_rows(problem, add_error, Sums::add_all).residual::<M>(problem)
}

/// The same of the model of friction that a problem is solved by: the natural map of its projection
/// (`problem::held`), over the same scale, so that both can be set side by side.
pub(crate) fn held_residual<M: Model, H: Held>(problem: &StepProblem<M::Kinematics>) -> f64 {
    let law = LawNumbers::of(problem);
    let compliance = 1.0 / M::Kinematics::TANGENTIAL_COMPLIANCE;
    let add_error = |sums: &mut Sums, (number, row): (usize, &Row<_>), motion: Motion| {
        let opening = motion.now[0] + row.restitution_velocity;
        let [normal, tangential] = [row.shifted_impulse, row.tangential_impulse];
        let trial = [normal - opening, tangential - compliance * motion.now[1]];
        let allowed = H::project::<M>(law, problem.held[number], trial);
        sums.add::<M>(row, [normal - allowed[0], tangential - allowed[1]], &motion);
    };
    sum_of_rows(problem, add_error, Sums::add_all).residual::<M>(problem)
}

/// The natural map's residual of what a problem is solved for: of its model of friction, or the common one.
pub(crate) fn natural_map<M: Model>(problem: &StepProblem<M::Kinematics>) -> f64 {
    match problem.friction_model {
        FrictionModel::Tresca if M::FRICTION => held_residual::<M, Bound>(problem),
        FrictionModel::Associated | FrictionModel::Desaxce if M::FRICTION => {
            held_residual::<M, Opening>(problem)
        }
        _ => residual::<M>(problem),
    }
}

/// The residual of the model of friction of a problem; none under Coulomb's law.
fn model_residual<M: Model>(
    problem: &StepProblem<M::Kinematics>,
    common_residual: f64,
) -> Option<f64> {
    match problem.friction_model {
        FrictionModel::Coulomb => None,
        // Without friction all models are one.
        _ if !M::FRICTION => Some(common_residual),
        _ => Some(natural_map::<M>(problem)),
    }
}

fn worst_of(one: Option<f64>, other: Option<f64>) -> Option<f64> {
    match (one, other) {
        (Some(one), Some(other)) => Some(worst(one, other)),
        (one, other) => one.or(other),
    }
}

/// The larger of two residuals or other measures of what went wrong: not a number where one is none.
pub fn worst(one: f64, other: f64) -> f64 {
    if one.is_nan() || other.is_nan() { f64::NAN } else { one.max(other) }
}

/// Residual, contact counts and works in one pass.
///
/// Work: from v^n = v^{n−1} + M⁻¹(ΔtF + HP) the kinetic energy changes by
/// ½(v^n + v^{n−1})·(ΔtF + HP), so a contact impulse does the work P·½(u^n + u^{n−1}) with u its
/// relative velocity. Summed with gravity's this closes the budget to rounding, whatever the solver
/// left undone. Where j is an image that slides, u is relative to that, and P·(what it slides by) is the border's work.
pub fn measure<M: Model>(problem: &StepProblem<M::Kinematics>) -> Measures {
    type Sum = (Sums, Measures);
    let visit = |(sums, measures): &mut Sum, (number, row): (usize, &Row<_>), motion: Motion| {
        sums.add_error::<M>(problem, (number, row), &motion);
        let [normal, tangential] = problem.reduced_impulse(number, row);
        let half_mass = 0.5 * row.effective_mass;
        measures.compressive_contacts += u32::from(normal > 0.0);
        measures.tensile_contacts += u32::from(normal < 0.0);
        measures.normal_work += half_mass * normal * (motion.now[0] + motion.before[0]);
        if M::FRICTION {
            measures.tangential_work += half_mass * tangential * (motion.now[1] + motion.before[1]);
        }
        if M::Kinematics::SLIDES {
            let [along_normal, along_tangent] = M::Kinematics::slide_along(row.normal);
            let work = normal * along_normal + tangential * along_tangent;
            measures.border_work += row.effective_mass * work;
        }
    };
    let (sums, mut measures) = sum_of_rows(problem, visit, |all: &mut Sum, (sums, measures)| {
        all.0.add_all(sums);
        all.1.add_rows(measures);
    });
    if problem.has_moving_walls() {
        let [whole, tangential_part] = problem.surface_works();
        measures.wall_work = whole;
        measures.tangential_work += tangential_part;
    }
    let residual = sums.residual::<M>(problem);
    let model_residual = model_residual::<M>(problem, residual);
    Measures { residual, model_residual, duality_gap: duality_gap::<M>(problem), ..measures }
}

/// (e_n, e_t) of [`residual`] over the effective masses, m/s, of contacts with these (σ, λ_t) and (v_n, v_t);
/// μ and the capture speed go before.
#[inline(always)]
pub(crate) fn errors<M: Model, T: Lanes>(
    [friction, capture_speed]: [f64; 2],
    [shifted, tangential]: [T; 2],
    restitution_velocity: T,
    [normal_velocity, tangential_velocity]: [T; 2],
) -> [T; 2] {
    let error = shifted - law::signorini(shifted - normal_velocity - restitution_velocity);
    if !M::FRICTION {
        return [error, error.same(0.0)];
    }
    let compliance = shifted.same(1.0 / M::Kinematics::TANGENTIAL_COMPLIANCE);
    let bound = M::friction_bound(friction, shifted, capture_speed);
    [error, tangential - law::coulomb(tangential - compliance * tangential_velocity, bound)]
}

/// The square of the scale of [`residual`], which is the same during a whole solve.
pub(crate) fn squared_residual_scale<M: Model>(problem: &StepProblem<M::Kinematics>) -> f64 {
    let add_scale = |sums: &mut Sums, (_, row): (usize, &Row<_>), motion: Motion| {
        sums.add_scale::<M>(row, motion.free);
    };
    sum_of_rows(problem, add_scale, Sums::add_all).scale
}

/// [`residual`] from the squares of its error and scale.
pub(crate) fn residual_of<M: Model>(
    problem: &StepProblem<M::Kinematics>,
    [squared_error, squared_scale]: [f64; 2],
) -> f64 {
    Sums { error: squared_error, scale: squared_scale }.residual::<M>(problem)
}

#[derive(Default)]
struct Sums {
    error: f64,
    scale: f64,
}

impl Sums {
    fn add_all(&mut self, other: Self) {
        self.error += other.error;
        self.scale += other.scale;
    }

    #[inline(always)]
    fn add_error<M: Model>(
        &mut self,
        problem: &StepProblem<M::Kinematics>,
        (number, row): (usize, &Row<M::Kinematics>),
        motion: &Motion,
    ) {
        let now = problem.own_part(number, row, motion.now).unwrap_or(motion.now);
        let numbers = [problem.friction, problem.capture_speed];
        let impulse = [row.shifted_impulse, row.tangential_impulse];
        let errors = errors::<M, f64>(numbers, impulse, row.restitution_velocity, now);
        self.add::<M>(row, errors, motion);
    }

    /// Adds the errors (e_n, e_t) of a row, m/s.
    #[inline(always)]
    fn add<M: Model>(
        &mut self,
        row: &Row<M::Kinematics>,
        [error, tangential_error]: [f64; 2],
        motion: &Motion,
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
    fn add_scale<M: Model>(&mut self, row: &Row<M::Kinematics>, free: [f64; 2]) {
        let squared_mass = row.effective_mass * row.effective_mass;
        let normal = free[0] + row.restitution_velocity;
        self.scale += squared_mass * normal * normal;
        if M::FRICTION {
            let compliance = 1.0 / M::Kinematics::TANGENTIAL_COMPLIANCE;
            let tangential = compliance * free[1];
            self.scale += squared_mass * tangential * tangential;
        }
    }

    fn residual<M: Model>(&self, problem: &StepProblem<M::Kinematics>) -> f64 {
        if self.error > 0.0 && self.scale == 0.0 {
            let squared = |row: &Row<M::Kinematics>| {
                let [normal, tangential] = [row.shifted_impulse, row.tangential_impulse];
                row.effective_mass.powi(2) * (normal * normal + tangential * tangential)
            };
            let rows = problem.fixed_rows.iter().chain(&problem.pair_rows);
            let impulses: f64 = rows.map(squared).sum();
            return if self.error <= ROUNDING * ROUNDING * impulses { 0.0 } else { f64::INFINITY };
        }
        if self.error > 0.0 { (self.error / self.scale).sqrt() } else { self.error.sqrt() }
    }
}
