//! Grains that overlap are moved apart after a step: bonds of the law `range` do not live on overlap.

use crate::contact::range::TOUCH_IN_DIAMETERS;
use crate::sim::state::State;
use crate::solver::{Kinematics, Model};

/// Passes over the contacts after a step. One carries an overlap on by a layer of grains at the least.
const PASSES: u32 = 8;

/// Moves grains out of each other, as far as a few passes go.
pub(super) fn separate<M: Model>(state: &mut State) {
    let State { world, contacts, candidates, .. } = state;
    let allowed = TOUCH_IN_DIAMETERS * world.mean_diameter;
    for _ in 0..PASSES {
        let found = if M::Kinematics::AXES == 1 {
            contacts.separate::<1>(world, candidates, allowed)
        } else {
            contacts.separate::<2>(world, candidates, allowed)
        };
        if !found {
            break;
        }
    }
}
