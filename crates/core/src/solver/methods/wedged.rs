//! Detects impulses of the previous step that are wedged by friction. No solve should start from such impulses.
//!
//! Discs in a ring, or in a box that is too small for them, can press on each other with any force if friction holds
//! them, without any effect on velocities: such impulses are in the null space of the problem. A warm start keeps the
//! wedged impulses of an unsolved step. Products of huge impulses and rounding errors of velocities then look like an
//! error. The interior point's path leads to the middle of all such impulses. If the friction bounds are computed from
//! these impulses, the middle moves: for three discs, whose |λ| = σ tan 30° stays within the bound μσ of the solve
//! before, by a factor of μ per solve. So above a certain μ impulses would grow from step to step until rounding stops
//! the solve.

use glam::DVec2;

use crate::solver::kinematics::Model;
use crate::solver::problem::{Bodies, StepProblem};
use crate::solver::settings::FrictionModel;

/// Friction coefficient μ above which the friction bounds of a step are assumed to come from wedged impulses. At
/// μ = 2.5 the root mean square of the impulses of piles stays at 9 to 100 grain weights (5 to 7 from a cold start) and
/// rises with Bond; at μ = 3 and Bond 20 the impulses grow to 3e4 grain weights in 0.3 s.
const WEDGING_FRICTION: f64 = 2.0;
/// Ratio of a contact's impulse to the sum of the momenta that contacts give to the bodies, above which the contact
/// counts as wedged. Levers and arches multiply the impulse only a few times.
const WEDGED: f64 = 3.0;

/// Returns true if friction may have wedged bodies between each other, so that the initial impulses of a solve are much
/// larger than the momenta of the bodies require.
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

/// Sets the impulses of all contacts to 0 for a cold start, instead of the impulses of the previous step.
pub(super) fn start_cold<M: Model>(problem: &mut StepProblem<M>) {
    for number in 0..problem.rows.len() {
        let capture_speed = problem.capture(number);
        let row = problem.rows.get_mut(number);
        (row.shifted_impulse, row.tangential_impulse) = (capture_speed, 0.0);
    }
    problem.rows.rolling.iter_mut().for_each(|rolling| rolling.impulse = 0.0);
    problem.form_velocities();
}
