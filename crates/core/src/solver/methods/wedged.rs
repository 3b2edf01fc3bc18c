//! Impulses of the step before from which no solve should start, because friction wedged them.
//!
//! Discs in a ring, or in a box that is too small for them, can press each other with any force if friction holds them,
//! and no velocity shows it: such impulses are a null space of the problem. A warm start keeps what an unsolved step put
//! there, and products of huge impulses with rounding errors of velocities then look like an error. The path of the interior
//! point leads to the middle of all such impulses, and under bounds of friction that come from these the middle moves:
//! for three discs, whose |λ| = σ tan 30° stays within the μσ of the solve before, by a factor μ a solve. So from some μ
//! on impulses would grow from step to step until rounding stops the solve.

use glam::DVec2;

use crate::solver::kinematics::Model;
use crate::solver::problem::{Bodies, StepProblem};
use crate::solver::settings::FrictionModel;

/// Above this μ the bounds of friction of a step are assumed to come from wedged impulses. At 2.5 the impulses of piles stay at
/// 9 to 100 grain weights in the root mean square (5 to 7 from a cold start), the more the higher Bond is; at 3 and Bond 20
/// they grow to 3e4 in 0.3 s.
const WEDGING_FRICTION: f64 = 2.0;
/// A contact is wedged if its impulse is more than this many times the momentum that all bodies are given. Levers and arches
/// multiply it a few times.
const WEDGED: f64 = 3.0;

/// True if friction may have wedged the impulses that a solve would start from.
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

/// Starts a solve without the impulses of the step before.
pub(super) fn start_cold<M: Model>(problem: &mut StepProblem<M>) {
    for number in 0..problem.rows.len() {
        let capture_speed = problem.capture(number);
        let row = problem.rows.get_mut(number);
        (row.shifted_impulse, row.tangential_impulse) = (capture_speed, 0.0);
    }
    problem.form_velocities();
}
