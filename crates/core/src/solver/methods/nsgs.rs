//! Non-linear Gauss–Seidel (M. Jean, 1999): one contact after the other, each solved exactly at the velocities that
//! result from the previous updates.
//!
//! The local Delassus block of a contact is the 2×2 matrix that maps its impulses to its velocities. For solid discs
//! this matrix is diagonal: a normal impulse does not change the tangential velocity. So a contact's solution is two
//! scalar projections (`methods::sweep`). Friction models other than Coulomb's law (`problem::friction`) have their own
//! projections.

use super::model_solves::solve_models;
use super::pass::{sweep_by, sweep_of_model};
use super::stopping::{SolveReport, is_tested, sweep_until_settled};
use crate::solver::kinematics::Model;
use crate::solver::method::Ordering;
use crate::solver::problem::{StepProblem, natural_map, with_projection};
use crate::solver::settings::{FrictionModel, SolverSettings};

/// Solves a prepared problem by Gauss–Seidel sweeps, under the problem's friction model.
pub(super) fn solve<M: Model>(
    problem: &mut StepProblem<M>,
    settings: &SolverSettings,
) -> SolveReport {
    solve_models(problem, settings, |problem| {
        let sweep = |problem: &mut StepProblem<M>, sweeps| {
            let backward = settings.ordering == Ordering::Symmetric && sweeps % 2 == 0;
            if is_tested(sweeps, settings) {
                return sweep_of_model(problem, settings, backward);
            }
            with_projection!(problem, M, P => sweep_by::<M, P, false>(problem, backward));
            false
        };
        sweep_until_settled(problem, settings, sweep, |problem| natural_map(problem))
    })
}
