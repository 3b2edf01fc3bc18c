//! A step's problem solved with what remedies make of its bounces.

use super::Simulation;
use super::step::{law, prepare};
use crate::error::Result;
use crate::solver::{
    self, Bounces, Kinematics, MethodKind, Model, SolveReport, gains_energy, scale_rebounds, solve,
};
use crate::world::ContactLaw;

/// How often bounces that gain energy with friction are halved, the last time to nothing.
const HALVINGS: u32 = 5;

/// Solves the prepared problem.
pub(super) fn solve_step<M: Model>(simulation: &mut Simulation) -> Result<SolveReport> {
    let followed = follow_impacts::<M>(simulation)?;
    let Simulation { solver, problems, .. } = simulation;
    let problem = M::Kinematics::problem(problems);
    let mut report = solve::<M>(problem, solver)?;
    let mut earlier = followed.unwrap_or_default();
    let mut halvings = 0;
    while M::FRICTION && followed.is_some() && halvings < HALVINGS && gains_energy(problem) {
        halvings += 1;
        scale_rebounds(problem, if halvings < HALVINGS { 0.5 } else { 0.0 });
        earlier.add(report);
        report = solve::<M>(problem, solver)?;
    }
    if !report.converged && solver.remedies.calm_unsolved {
        earlier.add(report);
        report = solve_without_bounces::<M>(simulation)?;
    }
    report.sweeps += earlier.sweeps;
    report.factorisations += earlier.factorisations;
    Ok(report)
}

/// Has the contacts of the prepared step open as its shocks say, where that is asked for.
pub(super) fn follow_impacts<M: Model>(simulation: &mut Simulation) -> Result<Option<SolveReport>> {
    let Simulation { world, parameters, solver, problems, contacts, .. } = simulation;
    let range = law(parameters, solver) == ContactLaw::Range;
    let scheme = solver.method.kind() != MethodKind::Problem;
    if !solver.remedies.sequential_impacts || range || scheme {
        return Ok(None);
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
