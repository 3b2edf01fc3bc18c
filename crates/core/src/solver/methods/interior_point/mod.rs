//! A primal–dual interior point method with a sparse direct factorisation.
//!
//! The solution of a convex friction model (`problem::friction`) consists of the allowed impulses p = (σ, λ) of all
//! contacts (normal impulse plus cohesion impulse σ, and tangential impulse λ, divided by the effective mass, m/s) that
//! minimise
//!
//! > ½‖V‖²_M + Σ m_ij s·σ,  V = V_free + M⁻¹ Hᵀ m (p − c),
//!
//! with V the velocities of the bodies, M their inertias, ½‖V‖²_M = ½ V·MV their kinetic energy, V_free their
//! velocities without contacts, H the map from V to contact velocities, m the effective masses m_ij of the contacts,
//! kg, s the opening speed that the friction model keeps fixed during a solve, m/s, and c the capture speed, m/s (the
//! opening speed that cohesion cancels in one step). The velocities V of the solution are unique. Each constraint of
//! the impulses has a slack and a multiplier (`contact`), whose product is 0 at the solution. The method follows the
//! *central path*, on which all products are equal and decrease (S. Mehrotra, 1992, for predictor and corrector; J.
//! Gondzio, 1996, for further corrections). V is always computed from the impulses, so that rounding errors do not add
//! up. Impulses are eliminated from each Newton step. One linear system for the change δV of the velocities remains,
//!
//! > (M + Hᵀ m S⁻¹ H) δV = Hᵀ m S⁻¹ b,
//!
//! with a positive definite matrix that has a block for each body and for each pair in contact. S and b are the matrix
//! and the right-hand side of a contact's own equations for the change of its impulses (`contact`). The number of
//! factorisations hardly depends on the number of contacts. In contrast, sweeps and the semi-smooth Newton method need
//! more iterations on a larger pile.
//!
//! If steps become short near the end, as on dense piles, which are hyperstatic, proximal multipliers (`proximal`)
//! finish the solve. If the path does not lead to a solution, proximal multipliers are tried from the impulses with the
//! smallest residual so far, which may be far from a solution.
//!
//! A solve begins with a few sweeps. Then the contact laws are applied once to all contacts, which projects their
//! impulses. The first interior point is a point of the path near the projected impulses; if this projection changes
//! the impulses less, the point is nearer to the end of the path.
//!
//! The problem of Coulomb's law is not convex, and its path may turn back (`path`).

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

/// Work memory of the interior point method, one part for each number of degrees of freedom of a body (1 to 3). A part
/// that is not used allocates nothing.
#[derive(Clone, Debug, Default)]
pub(crate) struct InteriorMemory {
    one: PathWorkspace<1>,
    two: PathWorkspace<2>,
    three: PathWorkspace<3>,
}

/// Solves a prepared problem under its friction model by the interior point method. If friction has wedged bodies
/// between each other, so that the impulses of the previous step are huge, the solve starts from zero impulses instead.
/// If the central path of Coulomb's law does not lead to a solution, `go_on` continues the solve with another method.
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

/// Solves a problem with its present friction bounds, which are not recomputed.
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

/// Follows the central path of Coulomb's law as far as possible, and then lets `go_on` continue with another method.
/// The path is not used in two cases. In the compressive cone, in which only the pushing part of the normal force
/// bounds friction, cohesion does not raise the bound, so the bound has a corner at a normal force of 0, which the path
/// cannot pass. In the other case, contacts have different friction coefficients.
fn coulomb<M: Model>(
    problem: &mut StepProblem<M>,
    memory: &mut InteriorMemory,
    settings: &SolverSettings,
    go_on: impl FnOnce(&mut StepProblem<M>, &SolverSettings) -> SolveReport,
) -> SolveReport {
    let InteriorMemory { two, three, .. } = memory;
    let report = match M::DEGREES {
        _ if problem.law.cone() == FrictionCone::Compressive => SolveReport::default(),
        _ if problem.rows.frictions.iter().any(|&own| own != problem.law.friction) => {
            SolveReport::default()
        }
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
