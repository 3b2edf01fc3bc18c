//! Which contacts a step has to do with: those at the present positions, or, for a law or a remedy that
//! looks ahead, those that the step may come to as well.

use super::step::law;
use super::{Simulation, range_step, speculative};
use crate::contact::LookAhead;
use crate::solver::{Kinematics, MethodKind, Model};
use crate::world::{ContactLaw, World};

/// Finds the contacts of the next step.
pub(super) fn detect<M: Model>(simulation: &mut Simulation) {
    let ahead = look_ahead(simulation);
    let Simulation { world, candidates, contacts, .. } = simulation;
    match (ahead, M::Kinematics::AXES) {
        (None, 1) => {
            candidates.update::<1>(world);
            contacts.detect::<1>(world, candidates);
        }
        (None, _) => {
            candidates.update::<2>(world);
            contacts.detect::<2>(world, candidates);
        }
        (Some(ahead), 1) => {
            candidates.update_ahead::<1>(world, ahead.reach);
            contacts.detect_ahead::<1>(world, candidates, ahead);
        }
        (Some(ahead), _) => {
            candidates.update_ahead::<2>(world, ahead.reach);
            contacts.detect_ahead::<2>(world, candidates, ahead);
        }
    }
}

/// How far the step has to look, if it looks ahead at all.
fn look_ahead(simulation: &Simulation) -> Option<LookAhead> {
    let Simulation { world, parameters, solver, walls, .. } = simulation;
    let look_ahead = if law(parameters, solver) == ContactLaw::Range {
        range_step::look_ahead
    } else if solver.remedies.speculative && solver.method.kind() == MethodKind::Problem {
        speculative::look_ahead
    } else {
        return None;
    };
    Some(look_ahead(world, fastest(world, walls.fastest()), parameters.time_step_secs))
}

/// Speed of the fastest grain or wall, m/s, with that of the fastest wall.
pub(super) fn fastest(world: &World, fastest_wall: f64) -> f64 {
    let speeds = world.grains.velocities.iter().map(|velocity| velocity.length());
    speeds.fold(fastest_wall, f64::max)
}
