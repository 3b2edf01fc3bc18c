//! How far from its least value a convex model's energy is: a bound that holds whatever solved it.
//!
//! With impulses p that a model allows and the velocities V that they make, let w and v of each contact be
//! those of the model (`problem::held`) and z ≥ 0 what w lacks of the allowed ones: w + z ≥ 0 within held
//! bounds g, w + s + z ≥ μ|v| on the cone. The velocities V solve the dual of a problem in which z is added to
//! w, and there the two energies differ by
//!
//! > Σ m_ij (σ (w + z) + g|v| + λv) within bounds,  Σ m_ij (σ (w + s + z) + λv) on the cone,
//!
//! each term ≥ 0. With what z itself is worth at the present impulses, Σ m_ij σz, the sum bounds
//! ‖V − V*‖²_M, V* the velocities of the solution, since the energy grows as the square of the distance from
//! there.

use super::kinematics::Kinematics;
use super::model::Model;
use super::motion::{ROUNDING, for_each_row};
use super::step_problem::StepProblem;
use crate::solver::friction_model::FrictionModel;

/// The duality gap of the model of friction that a problem was solved under, over Σ m_ij (v^free)² with v^free
/// as in the residual; dimensionless, ≥ 0 but for rounding. None under Coulomb's law, which has no dual.
///
/// Its square root bounds the error of the velocities, over those that the contacts had to undo.
pub(crate) fn duality_gap<M: Model>(problem: &StepProblem<M::Kinematics>) -> Option<f64> {
    let model = problem.friction_model;
    if model == FrictionModel::Coulomb {
        return None;
    }
    let on_cone = M::FRICTION && model != FrictionModel::Tresca;
    let (mut gap, mut scale, mut impulses) = (0.0, 0.0, 0.0);
    for_each_row::<M::Kinematics>(problem, |number, row, motion| {
        let held = problem.held.get(number).copied().unwrap_or(0.0);
        let [normal_velocity, tangential_velocity] = motion.now;
        let [shifted, tangential] = [row.shifted_impulse, row.tangential_impulse];
        let opening = normal_velocity + row.restitution_velocity + if on_cone { held } else { 0.0 };
        let across = tangential_velocity.abs();
        let least = if on_cone { problem.friction * across } else { 0.0 };
        let lacking = (least - opening).max(0.0);
        let mut of_contact = shifted * (opening + 2.0 * lacking);
        if M::FRICTION {
            of_contact += tangential * tangential_velocity;
            if !on_cone {
                of_contact += held * across;
            }
        }
        let free = motion.free[0] + row.restitution_velocity;
        let mut squared = free * free;
        if M::FRICTION {
            squared += motion.free[1] * motion.free[1] / M::Kinematics::TANGENTIAL_COMPLIANCE;
        }
        gap += row.effective_mass * of_contact;
        scale += row.effective_mass * squared;
        impulses += row.effective_mass * (shifted * shifted + tangential * tangential);
    });
    // Where nothing would move without contacts, what rounding left of the impulses is no gap.
    let is_rounding = gap.abs() <= ROUNDING * ROUNDING * impulses;
    Some(if is_rounding { 0.0 } else { gap / scale })
}
