//! A step under the law `range` (`contact::range`): contacts are looked for ahead, bonds are solved
//! for (`sim::bonds`), in substeps where they break, and what overlaps is pushed out.

use super::step::{Taken, move_by, prepare};
use super::{Simulation, bonds};
use crate::contact::range::TOUCH_IN_DIAMETERS;
use crate::contact::{Candidates, ContactList, LookAhead};
use crate::error::Result;
use crate::solver::{Kinematics, Measures, Model, SolveReport};
use crate::world::World;

/// Pairs within the first of these many diameters that a step could close are contacts;
/// a pair that is to meet within the step is one up to the second.
const AHEAD_IN_DIAMETERS: [f64; 2] = [0.25, 2.0];

/// Passes in which a step pushes grains out of each other. One carries an overlap on by a
/// layer of grains at the least.
const PASSES_OF_PUSHING: u32 = 8;

/// Finds the contacts that a step may have to do with.
pub(super) fn detect<M: Model>(
    world: &World,
    candidates: &mut Candidates,
    contacts: &mut ContactList,
    ahead: LookAhead,
) {
    if M::Kinematics::AXES == 1 {
        candidates.update_ahead::<1>(world, ahead.reach);
        contacts.detect_ahead::<1>(world, candidates, ahead);
    } else {
        candidates.update_ahead::<2>(world, ahead.reach);
        contacts.detect_ahead::<2>(world, candidates, ahead);
    }
}

/// How far a step has to look, with the speed of the fastest grain or wall (m/s): it tells what any
/// grain may come to.
pub(super) fn look_ahead(world: &World, fastest: f64, time_step_secs: f64) -> LookAhead {
    let fastest = fastest + 2.0 * world.gravity.magnitude() * time_step_secs;
    let [near, far] = AHEAD_IN_DIAMETERS.map(|most| most * world.mean_diameter);
    let distance = (fastest * time_step_secs).min(near);
    let reach = (distance + 2.0 * fastest * time_step_secs).min(far);
    LookAhead { time_step_secs, distance, reach, bonds: true }
}

/// Speed of the fastest grain or wall, m/s, with that of the fastest wall.
pub(super) fn fastest(world: &World, fastest_wall: f64) -> f64 {
    let speeds = world.grains.velocities.iter().map(|velocity| velocity.length());
    speeds.fold(fastest_wall, f64::max)
}

/// A step under the law `range`: as a whole, or in substeps where a bond breaks (`sim::bonds`).
pub(super) fn take<M: Model>(simulation: &mut Simulation) -> Result<Taken> {
    let Simulation { world, parameters, .. } = simulation;
    let whole = parameters.time_step_secs;
    let distance = parameters.debonding_distance * world.mean_diameter;
    let substeps = bonds::substeps(parameters, world.gravity.magnitude(), distance);
    let (given_up, taken) = try_step::<M>(simulation, distance, substeps == 1)?;
    if let Some(taken) = taken {
        return Ok(taken);
    }
    let mut sum = Taken { report: given_up, measures: Measures::default(), gravity_work: 0.0 };
    sum.report.converged = true;
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
    let Simulation { contacts, problems, parameters, solver, .. } = simulation;
    let problem = M::Kinematics::problem(problems);
    let (report, done) =
        bonds::solve_range::<M>(problem, contacts, parameters, distance, solver, may_break)?;
    if !done {
        return Ok((report, None));
    }
    let taken = move_by::<M>(simulation, report);
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
    }
}
