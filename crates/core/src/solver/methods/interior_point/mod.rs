//! A primal–dual interior point with a sparse direct factorisation.
//!
//! A convex model of friction (`problem::friction`) asks for the impulses p that make
//!
//! > ½‖V‖²_M + Σ m_ij s·σ,  V = V_free + M⁻¹ Hᵀ m (p − c),
//!
//! least among those that it allows; V is unique. With slacks and multipliers (`contact`) the solution is where
//! all their products are 0, and the method follows the path on which they are equal and fall (S. Mehrotra,
//! 1992, for predictor and corrector; J. Gondzio, 1996, for further corrections). V is always formed from the
//! impulses, so that rounding does not add up, and impulses are eliminated from each Newton step, which leaves
//! one system for the change of the velocities,
//!
//! > (M + Hᵀ m S⁻¹ H) δV = Hᵀ m S⁻¹ b,
//!
//! a positive definite matrix with a block for each body and each pair that touches. How often one is to be
//! factorised hardly depends on the number of contacts, which is what sets the method apart: sweeps and
//! guesses need more of everything on a larger pile.
//!
//! Where steps become short near the end, as on dense piles, whose contacts carry more than they need, proximal
//! multipliers (`proximal`) end the solve; where the path leads nowhere they are tried from far away.
//!
//! A start is the point of the path that is nearest to where the natural map leads from the impulses that sweeps leave,
//! as far along as these are good.
//!
//! Coulomb's law is no convex problem, and its path may turn back (`path`).

mod contact;
mod path;
mod point;
mod proximal;
mod proximal_contact;
mod system;
#[cfg(test)]
mod tests;

use self::contact::{Cone, HalfLine, Leaning, Shape, Strip};
use self::point::{InteriorPoint, PathWorkspace};
use super::model_solves::solve_models;
use super::stopping::SolveReport;
use super::wedged::{is_wedged, start_cold};
use crate::solver::kinematics::Model;
use crate::solver::problem::StepProblem;
use crate::solver::settings::{FrictionModel, SolverSettings};
use crate::world::FrictionCone;

/// A workspace for each number of degrees of freedom; those that are not used hold no memory.
#[derive(Clone, Debug, Default)]
pub(crate) struct InteriorMemory {
    one: PathWorkspace<1>,
    two: PathWorkspace<2>,
    three: PathWorkspace<3>,
}

/// Solves a prepared problem under the model of friction that it was prepared for, without the impulses of the step before
/// where friction wedged these. Where the path of Coulomb's law leads nowhere, `go_on` takes over.
pub(super) fn solve<M: Model>(
    problem: &mut StepProblem<M>,
    memory: &mut InteriorMemory,
    settings: &SolverSettings,
    mut go_on: impl FnMut(&mut StepProblem<M>, &SolverSettings) -> SolveReport,
) -> SolveReport {
    let mut is_first = true;
    solve_models(problem, settings, |problem| {
        if std::mem::take(&mut is_first) && is_wedged(problem) {
            start_cold(problem);
        }
        match problem.friction.model {
            _ if !M::FRICTION => convex::<M, HalfLine>(problem, memory, settings),
            FrictionModel::Tresca => convex::<M, Strip>(problem, memory, settings),
            FrictionModel::Associated | FrictionModel::Desaxce => {
                convex::<M, Cone>(problem, memory, settings)
            }
            _ => coulomb(problem, memory, settings, &mut go_on),
        }
    })
}

/// Solves a problem within the bounds of friction that it has.
#[cfg(test)]
pub(crate) fn solve_within_bounds<M: Model>(
    problem: &mut StepProblem<M>,
    settings: &SolverSettings,
) -> SolveReport {
    let memory = &mut InteriorMemory::default();
    if M::FRICTION {
        convex::<M, Strip>(problem, memory, settings)
    } else {
        convex::<M, HalfLine>(problem, memory, settings)
    }
}

fn convex<M: Model, S: Shape>(
    problem: &mut StepProblem<M>,
    memory: &mut InteriorMemory,
    settings: &SolverSettings,
) -> SolveReport {
    let InteriorMemory { one, two, three } = memory;
    match M::DEGREES {
        1 => InteriorPoint::<M, S, 1>::new(problem, settings, one).solve_convex(),
        2 => InteriorPoint::<M, S, 2>::new(problem, settings, two).solve_convex(),
        _ => InteriorPoint::<M, S, 3>::new(problem, settings, three).solve_convex(),
    }
}

/// Follows the path of Coulomb's law as far as it leads, and has another method go on from there. The
/// compressive cone has a corner at σ = c, which no path goes round.
fn coulomb<M: Model>(
    problem: &mut StepProblem<M>,
    memory: &mut InteriorMemory,
    settings: &SolverSettings,
    go_on: impl FnOnce(&mut StepProblem<M>, &SolverSettings) -> SolveReport,
) -> SolveReport {
    let InteriorMemory { two, three, .. } = memory;
    let report = match M::DEGREES {
        _ if problem.law.cone() == FrictionCone::Compressive => SolveReport::default(),
        2 => InteriorPoint::<M, Leaning, 2>::new(problem, settings, two).follow_path(),
        _ => InteriorPoint::<M, Leaning, 3>::new(problem, settings, three).follow_path(),
    };
    let left = settings.max_sweeps.saturating_sub(report.sweeps);
    if report.converged || left == 0 {
        return report;
    }
    let rest = SolverSettings { max_sweeps: left, ..*settings };
    go_on(problem, &rest).after(report)
}
