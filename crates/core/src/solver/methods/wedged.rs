//! Detects that bodies are wedged between each other by friction: the contact impulses of the previous step are then
//! huge but have no effect on velocities. No solve should start from such impulses.
//!
//! Discs in a ring, or in a box that is too small for them, can press on each other with any force if friction prevents
//! sliding, without any effect on velocities: such wedged impulses are in the null space of the problem. A warm start
//! keeps the wedged impulses of an unsolved step. Products of these huge impulses and the rounding errors of velocities
//! then look like an error of the solve. The path of the interior point method leads to the middle (the analytic
//! centre) of the set of all wedged impulses. If the friction bounds are computed from these impulses, the middle moves
//! with each solve. An example is three discs in a ring: they are in equilibrium with any normal impulse σ if each
//! contact has the tangential impulse |λ| = σ tan 30°. With a fixed friction bound g of |λ|, σ can have any value from
//! 0 to g/tan 30°, and the middle is at σ = g, where σ (g² − λ²) is largest. If g is the friction coefficient μ times
//! the σ of the solve before, each solve therefore multiplies the impulses at the middle by μ. So if μ is above 1 in
//! this example, impulses would grow from step to step until rounding stops the solve.

use glam::DVec2;

use crate::solver::kinematics::Model;
use crate::solver::problem::{Bodies, StepProblem};
use crate::solver::settings::FrictionModel;

/// Friction coefficient μ above which a solve with fixed friction bounds (`tresca`) never starts from the impulses of
/// the previous step. At μ = 2.5 the root mean square of the contact forces of piles (impulses divided by the time
/// step) stays at 9 to 100 times the weight of a grain, or at 5 to 7 times this weight if each step starts from zero
/// impulses. It rises with the Bond number. At μ = 3 and Bond number 20 the forces grow to 3e4 times the weight of a
/// grain in 0.3 s.
const WEDGING_FRICTION: f64 = 2.0;
/// Maximum ratio of a contact's normal impulse to the summed magnitudes of the momentum changes that contacts cause in
/// all bodies. A contact above this ratio counts as wedged. Levers and arches of grains make an impulse only a few
/// times as large as that sum.
const WEDGED: f64 = 3.0;

/// Returns true if friction may have wedged bodies between each other, so that the initial impulses of a solve are much
/// larger than the momentum changes of the bodies require.
pub(super) fn is_wedged<M: Model>(problem: &StepProblem<M>) -> bool {
    let model = problem.friction.model;
    if !M::FRICTION || !matches!(model, FrictionModel::Coulomb | FrictionModel::Tresca) {
        return false;
    }
    if model == FrictionModel::Tresca && problem.law.friction > WEDGING_FRICTION {
        return true;
    }
    let Bodies { now, free, masses, .. } = &problem.bodies;
    let bodies = now.iter().zip(free).zip(masses);
    let given = bodies.map(|((now, free), mass)| {
        let [now, free] = [now, free].map(M::coordinates);
        mass * DVec2::new(now[0] - free[0], now[1] - free[1]).length()
    });
    let most = WEDGED * given.sum::<f64>();
    problem
        .rows()
        .any(|(number, row)| row.effective_mass * problem.reduced_impulse(number, row)[0] > most)
}

/// Sets the impulses of all contacts to 0 (cold start). The solve then does not start from the impulses of the previous
/// step.
pub(super) fn start_cold<M: Model>(problem: &mut StepProblem<M>) {
    for number in 0..problem.rows.len() {
        let capture_speed = problem.capture(number);
        let row = problem.rows.get_mut(number);
        (row.shifted_impulse, row.tangential_impulse) = (capture_speed, 0.0);
    }
    problem.rows.rolling.iter_mut().for_each(|rolling| rolling.impulse = 0.0);
    problem.form_velocities();
}
