//! A step under the law `range` (`contact::range`): contacts are looked for ahead, bonds are solved
//! for (`sim::bonds`), in substeps where they break or grains go far, and what overlaps is pushed out.
//!
//! **Substeps.** Two things ask for them.
//!
//! * A step is long against the time √(2δ_c m_ij/C₀) of a break, and bonds are restless. A pile whose
//!   bonds are not is stepped at full length. Where the step before was cut and bonds were restless to
//!   its end, the next one is cut without being tried.
//! * Grains go far. A contact's normal is that of the beginning of the step, so the constraint
//!   v_n + gap/Δt ≥ 0 bars a grain from passing another one that it would have missed. Measured without
//!   cohesion at Δt = 5e-3 s over eight initial states, where only this asks for substeps: slump 0.430
//!   without them, 0.445 with at most 0.2 d a substep, 0.469 with 0.1 d, 0.473 with 0.05 d; at
//!   Δt = 2e-4 s it is 0.470 (± 0.010, standard error).

use super::Simulation;
use super::bonds::{BondEnergies, Solved, StepNumbers, solve_range};
use super::detection::fastest;
use super::step::{Taken, move_by, prepare};
use crate::contact::LookAhead;
use crate::contact::range::{TOUCH_IN_DIAMETERS, bond_time_secs};
use crate::error::Result;
use crate::solver::{Kinematics, Measures, Model, SolveReport};
use crate::world::World;

/// Pairs within the first of these many diameters that a step could close are contacts;
/// a pair that is to meet within the step is one up to the second.
const AHEAD_IN_DIAMETERS: [f64; 2] = [0.25, 2.0];

/// Longest substep where bonds are restless, in times of a break. Measured at Δt = 5e-3 s over six
/// initial states, before shocks were a problem of their own: slump at Bond 10 and 15 without substeps
/// 0.24 and 0.11, with substeps of a whole such time 0.26 and 0.12, of 0.4 of it 0.28 and 0.17.
const SUBSTEP_IN_BOND_TIMES: f64 = 0.4;

/// How far a grain goes in a substep, in diameters, as long as there are few enough of them.
const MOST_TRAVEL: f64 = 0.1;

/// More would be a step of another order than the one asked for.
const MOST_SUBSTEPS: f64 = 16.0;

/// Passes in which a step pushes grains out of each other. One carries an overlap on by a
/// layer of grains at the least.
const PASSES_OF_PUSHING: u32 = 8;

/// How far a step has to look, with the speed of the fastest grain or wall (m/s): it tells what any
/// grain may come to.
pub(super) fn look_ahead(world: &World, fastest: f64, time_step_secs: f64) -> LookAhead {
    let travel = travel(world, fastest, time_step_secs);
    let [near, far] = AHEAD_IN_DIAMETERS.map(|most| most * world.mean_diameter);
    let distance = travel.min(near);
    let reach = (distance + 2.0 * travel).min(far);
    LookAhead { time_step_secs, distance, reach, bonds: true }
}

/// How far a grain may go in a step where the fastest has that speed (m/s), m.
fn travel(world: &World, fastest: f64, time_step_secs: f64) -> f64 {
    (fastest + 2.0 * world.gravity.magnitude() * time_step_secs) * time_step_secs
}

/// A step under the law `range`: as a whole, or in substeps (see the module).
pub(super) fn take<M: Model>(simulation: &mut Simulation) -> Result<Taken> {
    let Simulation { world, parameters, walls, .. } = simulation;
    let whole = parameters.time_step_secs;
    let distance = parameters.debonding_distance * world.mean_diameter;
    let travel = travel(world, fastest(world, walls.fastest()), whole);
    let of_travel = (travel / (MOST_TRAVEL * world.mean_diameter)).ceil();
    let bond_time = bond_time_secs(parameters.bond, world.gravity.magnitude(), distance);
    let of_bonds = (whole / (SUBSTEP_IN_BOND_TIMES * bond_time)).ceil();
    let substeps = of_travel.max(of_bonds).clamp(1.0, MOST_SUBSTEPS) as u32;
    let mut sum = Taken {
        report: SolveReport { converged: true, ..SolveReport::default() },
        measures: Measures::default(),
        gravity_work: 0.0,
        bonds: Some(BondEnergies::default()),
    };
    let restless = std::mem::take(&mut simulation.bonds.restless);
    if substeps == 1 || (of_travel <= 1.0 && !restless) {
        let (given_up, taken) = try_step::<M>(simulation, distance, substeps == 1)?;
        if let Some(taken) = taken {
            return Ok(taken);
        }
        sum.report.add(given_up);
        sum.report.converged = true;
    }
    simulation.parameters.time_step_secs = whole / f64::from(substeps);
    let mut outcome = Ok(());
    for _ in 0..substeps {
        prepare::<M>(simulation);
        match try_step::<M>(simulation, distance, true) {
            Ok((_, Some(taken))) => sum.add(taken),
            Ok((_, None)) => {}
            Err(error) => outcome = Err(error),
        }
    }
    simulation.parameters.time_step_secs = whole;
    outcome.map(|()| sum)
}

/// Solves the prepared problem with its bonds and moves the grains; none where a bond breaks that may
/// not.
fn try_step<M: Model>(
    simulation: &mut Simulation,
    distance: f64,
    may_break: bool,
) -> Result<(SolveReport, Option<Taken>)> {
    let Simulation { world, contacts, problems, parameters, solver, bonds, .. } = simulation;
    let numbers = StepNumbers {
        time_step_secs: parameters.time_step_secs,
        restitution: parameters.restitution,
        debonding_distance: distance,
        touch: TOUCH_IN_DIAMETERS * world.mean_diameter,
        may_break,
    };
    let problem = M::Kinematics::problem(problems);
    let Solved { report, of_shocks, bonds, done } =
        solve_range::<M>(problem, contacts, bonds, numbers, solver)?;
    if !done {
        return Ok((report, None));
    }
    let mut taken = move_by::<M>(simulation, report);
    taken.bonds = Some(bonds);
    let measures = &mut taken.measures;
    measures.residual = measures.residual.max(of_shocks.residual);
    measures.normal_work += of_shocks.normal_work;
    measures.tangential_work += of_shocks.tangential_work;
    push_out::<M>(simulation);
    Ok((report, Some(taken)))
}

/// Pushes grains out of each other, as far as a few passes go.
fn push_out<M: Model>(simulation: &mut Simulation) {
    let Simulation { world, contacts, candidates, .. } = simulation;
    let allowed = TOUCH_IN_DIAMETERS * world.mean_diameter;
    for _ in 0..PASSES_OF_PUSHING {
        let found = if M::Kinematics::AXES == 1 {
            contacts.push_out::<1>(world, candidates, allowed)
        } else {
            contacts.push_out::<2>(world, candidates, allowed)
        };
        if !found {
            break;
        }
    }
}

impl Taken {
    /// Counts another substep; what it measures at its end counts for the whole.
    fn add(&mut self, other: Self) {
        let before = self.measures;
        self.report.add(other.report);
        self.measures = Measures {
            residual: before.residual.max(other.measures.residual),
            normal_work: before.normal_work + other.measures.normal_work,
            tangential_work: before.tangential_work + other.measures.tangential_work,
            ..other.measures
        };
        self.gravity_work += other.gravity_work;
        if let (Some(bonds), Some(other)) = (&mut self.bonds, other.bonds) {
            bonds.add(other);
        }
    }
}
