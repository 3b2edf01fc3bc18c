//! The outer loop of models of friction that lag (`problem::friction`), the same for all methods.

use super::pass::{settles_in, sweep};
use super::stopping::SolveReport;
use crate::solver::kinematics::Model;
use crate::solver::problem::StepProblem;
use crate::solver::settings::{FrictionModel, SolverSettings};

/// Sweeps under Coulomb's law that the first bounds of friction are taken from, and how many of them a step is given
/// first, which may be solved then: most of a pile at rest are. Fewer: what they are taken from is further from Coulomb's
/// law, at 2,000 grains more than what a first solve leads to; more: the sweeps cost more than the second solve that they save.
const SWEEPS_FOR_BOUNDS: [u32; 2] = [4, 46];

/// Solves a problem by `solve_once` as often as the settings ask for, the lagged numbers of its model of friction
/// taken anew each time. The step is solved where the last solve is: those before it only say what lags.
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

/// Sweeps under Coulomb's law, and takes the bounds of what that leads to.
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
