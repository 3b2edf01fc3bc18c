//! Decides whether the contact problem of a step is solved. No other code decides this.

use super::residual::{natural_map_sums, rounding, squared_impulse, squared_rolling};
use super::{StepProblem, velocity_error};
use crate::solver::kinematics::Model;
use crate::solver::settings::{SolverSettings, StopTest};

/// Returns true if a problem is solved to the tolerance of the settings. The test does not depend on the method that
/// solved the problem.
///
/// **Error bound from a small change**, for the stopping tests on the change of the impulses. The error e_k of contact
/// k (N·s) is the change that a Gauss–Seidel update would now make to its impulses; e is the vector of these errors. A
/// contact has no error just after its own update, and the later updates of the same sweep bring some error back. An
/// update projects impulses, and projections do not increase distances. So with W the Delassus operator (change of
/// contact velocities per impulse), m_k the effective mass (kg), and ΔP_l the change of the impulses of contact l in
/// the sweep (ΔP: of all contacts),
///
/// > |e_k| ≤ m_k Σ_l |W_kl ΔP_l|,  l the later contacts of the bodies of k.
///
/// No m_k is above the mass of a grain of contact k, so the norms obey ‖e‖ ≤ C‖ΔP‖ with a constant C. Among equal
/// discs, each with at most six contacts, C is at most 7.1, from the row and column sums of the matrix with the entries
/// m_k |W_kl|. In runs of all built-in scenes except the pile, ‖e‖ after a sweep was 0.14 ‖ΔP‖ in the median and 0.85
/// ‖ΔP‖ at most. Impulses that stop changing far from a solution, because nothing moves or because the method takes
/// small steps, have larger errors.
pub(crate) fn is_solved<M: Model>(problem: &StepProblem<M>, settings: &SolverSettings) -> bool {
    let tolerance = settings.tolerance;
    if settings.stop == StopTest::VelocityError {
        return velocity_error(problem).is_within(tolerance);
    }
    let map = natural_map_sums(problem);
    let change = match settings.stop {
        StopTest::RelativeChange => tolerance * squared_impulses(problem).sqrt(),
        StopTest::ImpulsePerMass => tolerance * problem.bodies.mean_mass,
        _ => return map.residual::<M>(problem) <= tolerance,
    };
    let error = map.error.sqrt();
    error.is_finite() && error <= LEFT_OF_CHANGE * change + rounding(problem)
}

/// Largest allowed ratio C of the error ‖e‖ to the change ‖ΔP‖, both N·s, after a sweep. e contains the changes that an
/// update would now make to the impulses of each contact, and ΔP the changes of the impulses in the sweep;
/// [`is_solved`] derives the ratio. With a smaller value, accurate results of sweeps among discs of many sizes might
/// count as unsolved. With a larger value, impulses that have stopped changing far from a solution would count as
/// solved.
const LEFT_OF_CHANGE: f64 = 8.0;

/// Returns Σ P² + Σ (MΔt/R)², (N·s)²: the sums over all contacts of the squared contact impulses P and the squared
/// rolling impulses, with the rolling moment M (N·m), the time step Δt (s) and the reduced radius R (m) of the two
/// bodies (1/R = 1/r_i + 1/r_j, with their radii r_i and r_j).
pub(crate) fn squared_impulses<M: Model>(problem: &StepProblem<M>) -> f64 {
    let squared = |number: usize| {
        let row = problem.rows.get(number);
        squared_impulse(row.effective_mass, problem.reduced_impulse(number, row))
    };
    let fixed = problem.rows.fixed.len();
    let squares = (0..fixed).map(squared).sum::<f64>()
        + (fixed..problem.rows.len()).map(squared).sum::<f64>();
    squares + squared_rolling(problem)
}
