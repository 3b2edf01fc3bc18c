//! The residual that is common to all methods, and the work of the contact forces.

use super::kinematics::Kinematics;
use super::model::Model;
use super::step_problem::{Row, StepProblem};
use crate::contact::law;

/// Where nothing would move without contacts, errors of up to this share of the impulses are what
/// rounding left, and no residual. Smaller: methods that scale impulses would not have solved a step in
/// which nothing happens; larger: errors would go unseen.
const ROUNDING: f64 = 1e-14;

/// What one pass over the rows tells of a solved step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measures {
    /// The common residual, dimensionless.
    pub residual: f64,
    /// Contacts with P_n > 0.
    pub compressive_contacts: u32,
    /// Contacts with P_n < 0.
    pub tensile_contacts: u32,
    /// Work of the normal impulses, J.
    pub normal_work: f64,
    /// Work of the tangential impulses, J.
    pub tangential_work: f64,
}

impl Measures {
    /// Counts another piece of the same step; the contacts are those at its end.
    pub fn add(&mut self, piece: Self) {
        let Self { residual, compressive_contacts, tensile_contacts, normal_work, tangential_work } =
            piece;
        self.residual = worst(self.residual, residual);
        self.compressive_contacts = compressive_contacts;
        self.tensile_contacts = tensile_contacts;
        self.normal_work += normal_work;
        self.tangential_work += tangential_work;
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
pub fn residual<M: Model>(problem: &StepProblem<M::Kinematics>) -> f64 {
    let mut sums = Sums::default();
    for_each_row::<M::Kinematics>(problem, |_, row, motion| {
        sums.add_error::<M>(problem, row, &motion)
    });
    sums.residual::<M>(problem)
}

/// The larger of two residuals or other measures of what went wrong: not a number where one is none.
pub(crate) fn worst(one: f64, other: f64) -> f64 {
    if one.is_nan() || other.is_nan() { f64::NAN } else { one.max(other) }
}

/// Residual, contact counts and works in one pass.
///
/// Work: from v^n = v^{n−1} + M⁻¹(ΔtF + HP) the kinetic energy changes by
/// ½(v^n + v^{n−1})·(ΔtF + HP), so a contact impulse does the work P·½(u^n + u^{n−1}) with u its
/// relative velocity. Summed with gravity's this closes the budget to rounding, whatever the solver
/// left undone.
pub(crate) fn measure<M: Model>(problem: &StepProblem<M::Kinematics>) -> Measures {
    let mut sums = Sums::default();
    let mut measures = Measures::default();
    for_each_row::<M::Kinematics>(problem, |number, row, motion| {
        sums.add_error::<M>(problem, row, &motion);
        let [normal, tangential] = problem.reduced_impulse(number, row);
        let half_mass = 0.5 * row.effective_mass;
        measures.compressive_contacts += u32::from(normal > 0.0);
        measures.tensile_contacts += u32::from(normal < 0.0);
        measures.normal_work += half_mass * normal * (motion.now[0] + motion.before[0]);
        if M::FRICTION {
            measures.tangential_work += half_mass * tangential * (motion.now[1] + motion.before[1]);
        }
    });
    Measures { residual: sums.residual::<M>(problem), ..measures }
}

/// Relative (normal, tangential) velocities of one contact, m/s.
pub struct Motion {
    /// At the end of the step.
    pub now: [f64; 2],
    /// At its beginning.
    pub before: [f64; 2],
    /// At the end if no contact acted.
    pub free: [f64; 2],
}

/// Visits the rows with their numbers and motions.
pub(crate) fn for_each_row<K: Kinematics>(
    problem: &StepProblem<K>,
    mut visit: impl FnMut(usize, &Row<K>, Motion),
) {
    for (number, row) in problem.fixed_rows.iter().enumerate() {
        let of = |bodies: &[K::Body<f64>]| K::velocity(row.normal, &bodies[row.i as usize]);
        let (now, before, free) = (of(&problem.bodies), of(&problem.before), of(&problem.free));
        visit(number, row, Motion { now, before, free });
    }
    for (number, row) in (problem.fixed_rows.len()..).zip(&problem.pair_rows) {
        let of = |bodies: &[K::Body<f64>]| {
            K::relative_velocity(row.normal, &bodies[row.i as usize], &bodies[row.j as usize])
        };
        let (now, before, free) = (of(&problem.bodies), of(&problem.before), of(&problem.free));
        visit(number, row, Motion { now, before, free });
    }
}

/// v_n of every row among `bodies`, relative to a wall that moves, m/s; `speeds` is cleared first.
pub(crate) fn relative_velocities<K: Kinematics>(
    problem: &StepProblem<K>,
    bodies: &[K::Body<f64>],
    speeds: &mut Vec<f64>,
) {
    let StepProblem { fixed_rows, pair_rows, .. } = problem;
    speeds.clear();
    speeds.extend(fixed_rows.iter().map(|row| K::velocity(row.normal, &bodies[row.i as usize])[0]));
    speeds.extend(pair_rows.iter().map(|row| {
        K::relative_velocity(row.normal, &bodies[row.i as usize], &bodies[row.j as usize])[0]
    }));
    for (speed, wall_speed) in speeds.iter_mut().zip(&problem.wall_speeds) {
        *speed -= wall_speed;
    }
}

#[derive(Default)]
struct Sums {
    error: f64,
    scale: f64,
}

impl Sums {
    #[inline(always)]
    fn add_error<M: Model>(
        &mut self,
        problem: &StepProblem<M::Kinematics>,
        row: &Row<M::Kinematics>,
        motion: &Motion,
    ) {
        let squared_mass = row.effective_mass * row.effective_mass;
        let shifted = row.shifted_impulse;
        let error = shifted - law::signorini(shifted - motion.now[0] - row.restitution_velocity);
        self.error += squared_mass * error * error;
        let free = motion.free[0] + row.restitution_velocity;
        self.scale += squared_mass * free * free;
        if M::FRICTION {
            let compliance = 1.0 / M::Kinematics::TANGENTIAL_COMPLIANCE;
            let tangential = row.tangential_impulse;
            let bound = problem.friction_bound::<M>(shifted);
            let error = tangential - law::coulomb(tangential - compliance * motion.now[1], bound);
            self.error += squared_mass * error * error;
            let free = compliance * motion.free[1];
            self.scale += squared_mass * free * free;
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
