//! A step cut into pieces, so that no grain jumps over what it should hit.

use super::detection::fastest;
use super::{Observables, Simulation, step};
use crate::error::Result;
use crate::solver::MethodKind;

/// Most pieces of a step: a grain that is faster still is lost anyhow, and the step has to end.
const MOST_PIECES: f64 = 1000.0;

/// Pieces of the next step: 1 unless grains are too fast for it.
pub(super) fn pieces(simulation: &Simulation) -> u32 {
    let Simulation { world, parameters, solver, .. } = simulation;
    let longest = solver.remedies.max_travel * world.mean_diameter;
    if longest == 0.0 || solver.method.kind() != MethodKind::Problem {
        return 1;
    }
    let time_step_secs = parameters.time_step_secs;
    let mut travel = fastest(world, simulation.fastest_wall()) * time_step_secs
        + world.gravity.magnitude() * time_step_secs * time_step_secs;
    if let Some(pull) = simulation.pull {
        travel += world.grains.positions[pull.grain as usize].distance(pull.target);
    }
    (travel / longest).ceil().clamp(1.0, MOST_PIECES) as u32
}

/// Takes one step in pieces. Its observables are those of the whole step.
pub(super) fn take(simulation: &mut Simulation, pieces: u32) -> Result<()> {
    let whole = simulation.parameters;
    let before = simulation.observables;
    simulation.parameters.time_step_secs /= f64::from(pieces);
    let mut sum = Observables { converged: true, bond_work: None, ..before };
    (sum.sweeps, sum.factorisations, sum.residual, sum.stalled) = (0, 0, 0.0, false);
    (sum.normal_work, sum.tangential_work, sum.gravity_work) = (0.0, 0.0, 0.0);
    let mut outcome = Ok(());
    for _ in 0..pieces {
        outcome = step::take(simulation);
        if outcome.is_err() || !simulation.is_finite() {
            break;
        }
        let piece = &simulation.observables;
        sum.sweeps += piece.sweeps;
        sum.factorisations += piece.factorisations;
        sum.converged &= piece.converged;
        sum.stalled |= piece.stalled;
        sum.residual = sum.residual.max(piece.residual);
        sum.normal_work += piece.normal_work;
        sum.tangential_work += piece.tangential_work;
        sum.gravity_work += piece.gravity_work;
        sum.bond_work = piece.bond_work.map(|work| work + sum.bond_work.unwrap_or(0.0));
    }
    simulation.parameters = whole;
    simulation.observables = Observables {
        step: before.step + 1,
        time_secs: before.time_secs + whole.time_step_secs,
        time_step_secs: whole.time_step_secs,
        sweeps: sum.sweeps,
        factorisations: sum.factorisations,
        converged: sum.converged,
        stalled: sum.stalled,
        residual: sum.residual,
        normal_work: sum.normal_work,
        tangential_work: sum.tangential_work,
        gravity_work: sum.gravity_work,
        bond_work: sum.bond_work,
        ..simulation.observables
    };
    outcome
}
