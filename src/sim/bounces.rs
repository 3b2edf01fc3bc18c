//! A step's problem solved with what remedies make of its bounces.

use super::Simulation;
use super::step::{law, prepare};
use crate::error::Result;
use crate::solver::{self, Bounces, Kinematics, MethodKind, Model, SolveReport, solve};
use crate::world::ContactLaw;

/// Solves the prepared problem.
pub(super) fn solve_step<M: Model>(simulation: &mut Simulation) -> Result<SolveReport> {
    let mut earlier = follow_impacts::<M>(simulation)?;
    let Simulation { solver, problems, .. } = simulation;
    let mut report = solve::<M>(M::Kinematics::problem(problems), solver)?;
    if !report.converged && solver.remedies.calm_unsolved {
        earlier.add(report);
        report = solve_without_bounces::<M>(simulation)?;
    }
    report.sweeps += earlier.sweeps;
    report.factorisations += earlier.factorisations;
    Ok(report)
}

/// Has the contacts of the prepared step open as its shocks say, where that is asked for.
pub(super) fn follow_impacts<M: Model>(simulation: &mut Simulation) -> Result<SolveReport> {
    let Simulation { world, parameters, solver, problems, contacts, .. } = simulation;
    let range = law(parameters, solver) == ContactLaw::Range;
    let scheme = solver.method.kind() != MethodKind::Problem;
    if !solver.remedies.sequential_impacts || range || scheme {
        return Ok(SolveReport::default());
    }
    let bounces = Bounces {
        restitution: parameters.restitution,
        threshold: parameters.restitution_threshold,
        step_of_gravity: world.gravity.magnitude() * parameters.time_step_secs,
    };
    solver::follow_impacts::<M>(M::Kinematics::problem(problems), contacts, bounces, solver)
}

/// Solves the step anew with ρ = 0, from the impulses of the step before. What it measures is the
/// residual of that problem.
fn solve_without_bounces<M: Model>(simulation: &mut Simulation) -> Result<SolveReport> {
    let restitution = std::mem::take(&mut simulation.parameters.restitution);
    // Detection at the same places finds the same contacts, and their impulses with them.
    prepare::<M>(simulation);
    simulation.parameters.restitution = restitution;
    let Simulation { solver, problems, .. } = simulation;
    solve::<M>(M::Kinematics::problem(problems), solver)
}
