//! Measures of a solved step, computed in one pass over the contacts: residual, velocity error, contact counts and
//! works.

use super::residual::{Sums, natural_map};
use super::row_velocities::{RowVelocities, sum_of_rows};
use super::velocity_error::ErrorSums;
use super::{Row, StepProblem};
use crate::solver::kinematics::Model;
use crate::solver::settings::FrictionModel;

/// Errors, contact counts and works of a solved step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measures {
    /// Residual under Coulomb's law, dimensionless: the error of the impulses in the contact laws, divided by the
    /// impulses that would stop the relative motion at the contacts ([`residual`](fn@super::residual)). It is the same
    /// measure for all methods and friction models.
    pub residual: f64,
    /// Residual of the convex friction model under which the step was solved, dimensionless; `None` if the step was
    /// solved under Coulomb's law, because it would then equal `residual`.
    pub model_residual: Option<f64>,
    /// Estimated distance of the velocities from velocities that satisfy Coulomb's law, whichever friction model the
    /// step was solved under, m/s: the root mean square over the grains with contacts, weighted by mass
    /// ([`VelocityError`](super::VelocityError)).
    pub velocity_error: f64,
    /// Number of contacts whose bodies push each other (normal impulse above 0).
    pub compressive_contacts: u32,
    /// Number of contacts whose bodies pull each other (normal impulse below 0).
    pub tensile_contacts: u32,
    /// Work of the normal contact impulses on the grains in the step, J.
    pub normal_work: f64,
    /// Work of the tangential contact impulses and of the rolling moments on the grains in the step, J.
    pub tangential_work: f64,
    /// Work that moving walls and other moving bodies that are not grains do on the grains, J; contained in the normal
    /// and tangential work.
    pub wall_work: f64,
    /// Work that periodic images of grains do on the grains that touch them across a sheared border, J; not contained
    /// in the other works. A sheared border is a periodic border beyond which the images move along the border.
    pub border_work: f64,
}

impl Measures {
    /// Sets `model_residual`, the residual of the friction model that the step was solved under, to `residual` if the
    /// step was solved under Coulomb's law and so has no model residual. In a run with a convex friction model, every
    /// step then has a model residual, also the steps that were solved under Coulomb's law.
    pub(crate) fn measure_as_a_model(&mut self) {
        self.model_residual = self.model_residual.or(Some(self.residual));
    }

    /// Adds the contact counts and works of `rows`, the measures of further contacts of the same problem, to the counts
    /// and works of these measures.
    fn add_rows(&mut self, rows: Self) {
        self.compressive_contacts += rows.compressive_contacts;
        self.tensile_contacts += rows.tensile_contacts;
        self.normal_work += rows.normal_work;
        self.tangential_work += rows.tangential_work;
        self.border_work += rows.border_work;
    }

    /// Adds the measures `piece` of the next substep, if a step is divided into shorter steps. Works are added. Of each
    /// kind of error the larger value is kept. The contact counts become those of the last substep.
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

/// Returns the residual of a problem under its own friction model, dimensionless; `None` if this model is Coulomb's
/// law. `common_residual` is the residual under Coulomb's law. If contacts have no friction, all friction models are
/// the same, so `common_residual` is then also the result for a convex model.
fn model_residual<M: Model>(problem: &StepProblem<M>, common_residual: f64) -> Option<f64> {
    match problem.friction.model {
        FrictionModel::Coulomb => None,
        // Without friction all friction models are the same.
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

/// Returns the larger of two residuals or other errors; NaN if an argument is NaN.
pub fn worst(one: f64, other: f64) -> f64 {
    if one.is_nan() || other.is_nan() { f64::NAN } else { one.max(other) }
}

/// Computes residual, velocity error, contact counts and works of a problem in one pass over its contacts.
///
/// Works are computed so that the energy balance closes. From v^n = v^{n−1} + M⁻¹(ΔtF + HP) (v^{n−1} and v^n:
/// velocities of the bodies before and after the step, M: inertias, Δt: time step, F: gravity, HP: contact impulses P
/// as impulses on the bodies) the kinetic energy changes by ½(v^n + v^{n−1})·(ΔtF + HP). So a contact impulse P does
/// the work P·½(u^n + u^{n−1}), with u^{n−1} and u^n the relative velocities of the contact before and after the step.
/// Together with the work of gravity this closes the energy balance to rounding, however large the solver's error is.
/// If a grain touches the periodic image of another grain across a sheared border (beyond which images move along the
/// border), u^{n−1} and u^n are relative to the image. P times the velocity of the image relative to the other grain
/// itself is then the work of the border.
// Without inlining, the function is compiled once per model, in this crate.
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
        if let Some((rolling, now)) = problem.rolling(number, row, &problem.bodies.now) {
            let before = problem.rolling(number, row, &problem.bodies.before);
            let sum = now + before.map_or(0.0, |(_, velocity)| velocity);
            measures.tangential_work += half_mass * rolling.impulse * sum;
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
