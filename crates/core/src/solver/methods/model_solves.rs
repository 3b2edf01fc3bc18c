//! The repeated solves of one step under a convex friction model (`problem::friction`). Such a model keeps one number
//! per contact fixed during each solve: a friction bound, or an opening speed that is added to the normal velocity. All
//! methods share this code.

use super::pass::{settles_in, sweep};
use super::stopping::SolveReport;
use crate::solver::kinematics::Model;
use crate::solver::problem::StepProblem;
use crate::solver::settings::{FrictionModel, SolverSettings};

/// Numbers of sweeps under Coulomb's law that estimate the friction bounds of a solve under `tresca`, in two stages.
/// The stopping test is made after each stage; most steps of a pile at rest are solved after the first stage. With
/// fewer sweeps the bounds are worse: at 2,000 grains they are further from Coulomb's law than bounds computed from the
/// impulses of a complete solve under `tresca`. More sweeps cost more computing time than a second solve of the step,
/// which good bounds make unnecessary.
const SWEEPS_FOR_BOUNDS: [u32; 2] = [4, 46];

/// Solves a problem with `solve_once` as often as the settings require. Before each further solve, recomputes the
/// numbers that the friction model keeps fixed during a solve: friction bounds, or opening speeds that are added to
/// normal velocities. The step counts as solved if the last solve has converged; the earlier solves only provide these
/// numbers.
pub(super) fn solve_models<M: Model>(
    problem: &mut StepProblem<M>,
    settings: &SolverSettings,
    mut solve_once: impl FnMut(&mut StepProblem<M>) -> SolveReport,
) -> SolveReport {
    if !M::FRICTION || problem.friction.model == FrictionModel::Coulomb {
        return solve_once(problem);
    }
    let mut report = SolveReport::default();
    match problem.friction.model {
        FrictionModel::Tresca => take_bounds_from_sweeps(problem, settings, &mut report),
        model => problem.begin_friction(model),
    }
    report = solve_once(problem).after(report);
    for _ in 1..settings.model_solves {
        problem.renew_friction();
        report = solve_once(problem).after(report);
    }
    report
}

/// Performs sweeps under Coulomb's law, and computes the friction bounds of `tresca` from the result.
fn take_bounds_from_sweeps<M: Model>(
    problem: &mut StepProblem<M>,
    settings: &SolverSettings,
    report: &mut SolveReport,
) {
    for sweeps in SWEEPS_FOR_BOUNDS {
        for _ in 0..sweeps {
            sweep::<M, false>(problem);
        }
        report.sweeps += sweeps;
        problem.renew_friction();
        if settles_in(problem, settings, 1, report) {
            return;
        }
    }
}
