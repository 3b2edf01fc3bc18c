//! The residual that is common to all methods, and the work of the contact forces.

use std::ops::Range;

use super::velocity_error::ErrorSums;
use super::{FrictionProjection, Row, StepProblem, squared_impulse, with_projection};
use crate::contact::{ContactLaw, Lanes, law};
use crate::solver::kinematics::Model;
use crate::solver::settings::FrictionModel;
use crate::threads;

/// What one pass over the rows tells of a solved step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measures {
    /// The common residual, dimensionless.
    pub residual: f64,
    /// The natural map of the model of friction that was solved, likewise; none under Coulomb's law, whose
    /// it is already.
    pub model_residual: Option<f64>,
    /// How far the velocities are from those that Coulomb's law asks for, whatever was solved, m/s: an estimate of the root
    /// mean square over the grains that touch something, weighted with mass ([`VelocityError`](super::VelocityError)).
    pub velocity_error: f64,
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
    /// under a model of friction: its common residual.
    pub(crate) fn measure_as_a_model(&mut self) {
        self.model_residual = self.model_residual.or(Some(self.residual));
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
        let Self { residual, model_residual, velocity_error, .. } = piece;
        let Self { compressive_contacts, tensile_contacts, .. } = piece;
        let Self { normal_work, tangential_work, wall_work, border_work, .. } = piece;
        self.residual = worst(self.residual, residual);
        self.model_residual = worst_of(self.model_residual, model_residual);
        self.velocity_error = worst(self.velocity_error, velocity_error);
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
pub fn residual<M: Model>(problem: &StepProblem<M>) -> f64 {
    common_map(problem).residual::<M>(problem)
}

/// What [`residual`] is made of.
pub(super) fn common_map<M: Model>(problem: &StepProblem<M>) -> Sums {
    let add_error = |sums: &mut Sums, (number, row): (usize, &Row<_>), motion: RowVelocities| {
        sums.add_error(problem, number, row, &motion);
    };
    sum_of_rows(problem, add_error, Sums::add_all)
}

/// The same of the model of friction that a problem is solved by: the natural map of its projection
/// (`problem::friction`), over the same scale, so that both can be set side by side.
pub(super) fn projection_map<M: Model, P: FrictionProjection>(problem: &StepProblem<M>) -> Sums {
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

/// The natural map's residual of what a problem is solved for: of its model of friction, or the common one.
pub(crate) fn natural_map<M: Model>(problem: &StepProblem<M>) -> f64 {
    with_projection!(problem, M, P => P::residual(problem))
}

/// The residual of the model of friction of a problem; none under Coulomb's law.
fn model_residual<M: Model>(problem: &StepProblem<M>, common_residual: f64) -> Option<f64> {
    match problem.friction.model {
        FrictionModel::Coulomb => None,
        // Without friction all models are one.
        _ if !M::FRICTION => Some(common_residual),
        _ => Some(natural_map(problem)),
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
// Compiled once, in this crate.
#[inline(never)]
pub fn measure<M: Model>(problem: &StepProblem<M>) -> Measures {
    type Sum = (Sums, ErrorSums, Measures);
    let visit = |(sums, of_law, measures): &mut Sum,
                 (number, row): (usize, &Row<_>),
                 motion: RowVelocities| {
        sums.add_error(problem, number, row, &motion);
        of_law.add_by_law(problem, number, row, &motion);
        let [normal, tangential] = problem.reduced_impulse(number, row);
        let half_mass = 0.5 * row.effective_mass;
        measures.compressive_contacts += u32::from(normal > 0.0);
        measures.tensile_contacts += u32::from(normal < 0.0);
        measures.normal_work += half_mass * normal * (motion.now[0] + motion.before[0]);
        if M::FRICTION {
            measures.tangential_work += half_mass * tangential * (motion.now[1] + motion.before[1]);
        }
        if M::SLIDES {
            let [along_normal, along_tangent] = M::slide_along(row.normal);
            let work = normal * along_normal + tangential * along_tangent;
            measures.border_work += row.effective_mass * work;
        }
    };
    let join = |all: &mut Sum, (sums, of_law, measures)| {
        all.0.add_all(sums);
        all.1.add_all(of_law);
        all.2.add_rows(measures);
    };
    let (sums, of_law, mut measures) = sum_of_rows(problem, visit, join);
    if problem.has_moving_walls() {
        let [whole, tangential_part] = problem.surface_works();
        measures.wall_work = whole;
        measures.tangential_work += tangential_part;
    }
    let residual = sums.residual::<M>(problem);
    let model_residual = model_residual(problem, residual);
    let velocity_error = of_law.error(problem);
    Measures { residual, model_residual, velocity_error, ..measures }
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
    fn add_all(&mut self, other: Self) {
        self.error += other.error;
        self.scale += other.scale;
    }

    #[inline(always)]
    fn add_error<M: Model>(
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

/// Relative (normal, tangential) velocities of one contact, m/s: along the tangent relative to a surface that
/// moves.
pub struct RowVelocities {
    /// At the end of the step.
    pub now: [f64; 2],
    /// At its beginning.
    pub before: [f64; 2],
    /// At the end if no contact acted.
    pub free: [f64; 2],
}

/// Visits the rows with their numbers and motions.
pub fn for_each_row<M: Model>(
    problem: &StepProblem<M>,
    visit: impl FnMut(usize, &Row<M>, RowVelocities),
) {
    for_each_row_of(problem, 0..problem.rows.len(), visit);
}

/// Adds up what rows come to, in stretches of one length: `visit` adds a row to the sum of its stretch, `join` that of
/// the next stretch to those before.
pub(super) fn sum_of_rows<M: Model, S: Default + Send>(
    problem: &StepProblem<M>,
    visit: impl Fn(&mut S, (usize, &Row<M>), RowVelocities) + Sync,
    join: impl Fn(&mut S, S),
) -> S {
    let of_stretch = |stretch: Range<usize>| {
        let mut sum = S::default();
        for_each_row_of(problem, stretch, |number, row, motion| {
            visit(&mut sum, (number, row), motion);
        });
        sum
    };
    let mut all = S::default();
    threads::add_up(problem.rows.len(), of_stretch, |sum| join(&mut all, sum));
    all
}

#[inline(always)]
fn for_each_row_of<M: Model>(
    problem: &StepProblem<M>,
    rows: Range<usize>,
    mut visit: impl FnMut(usize, &Row<M>, RowVelocities),
) {
    let (bodies, fixed) = (&problem.bodies, problem.rows.fixed.len());
    for number in rows.start..rows.end.min(fixed) {
        let row = &problem.rows.fixed[number];
        let [now, before, free] =
            [&bodies.now, &bodies.before, &bodies.free].map(|bodies| row.velocity(bodies));
        // Without contacts a driven wall would go otherwise, too.
        let free = problem.free_part(number, row, free).unwrap_or(free);
        visit(number, row, RowVelocities { now, before, free });
    }
    for number in rows.start.max(fixed)..rows.end {
        let row = &problem.rows.pairs[number - fixed];
        let [now, before, free] =
            [&bodies.now, &bodies.before, &bodies.free].map(|bodies| row.velocity(bodies));
        visit(number, row, RowVelocities { now, before, free });
    }
}

/// v_n of every row among `bodies`, relative to a wall that moves, m/s; `speeds` is cleared first.
pub fn relative_velocities<M: Model>(
    problem: &StepProblem<M>,
    bodies: &[M::Body<f64>],
    speeds: &mut Vec<f64>,
) {
    speeds.clear();
    speeds.reserve(problem.rows.len());
    problem.for_each_velocity(bodies, |_, [normal, _]| speeds.push(normal));
    for (speed, wall_speed) in speeds.iter_mut().zip(&problem.walls.speeds) {
        *speed -= wall_speed;
    }
}
