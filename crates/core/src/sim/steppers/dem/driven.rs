//! Walls that a force drives, among springs: like grains they go on by the forces of the beginning of a substep.
//!
//! That is stable while h < 2 √(M/nk) of a wall of mass M with n contacts of stiffness k, which is surely so where M is
//! that of as many of the lightest grains: substeps are short enough for those.

use crate::sim::state::State;
use crate::sim::steppers::course::Works;
use crate::sim::stepping::Stage;
use crate::solver::{DrivenWall, Model};

/// Ends a substep of such walls; `pushes` are m_ij, the impulses λ and the velocity of the wall (m/s) of each contact.
pub(super) fn drive<M: Model>(
    stage: &mut Stage<'_, M>,
    substep_secs: f64,
    pushes: &[(f64, [f64; 2], [f64; 2])],
    works: &mut Works,
) {
    let State { world, walls, contacts, .. } = &mut *stage.state;
    let mut driven: Vec<DrivenWall> = walls.driven(world, substep_secs).collect();
    if driven.is_empty() {
        return;
    }
    driven.iter_mut().for_each(|wall| wall.now = wall.free);
    let pushed = || {
        contacts.contacts().iter().zip(pushes).filter_map(|(contact, &(mass, impulse, _))| {
            let by = walls.surface(world, contact)?.driven?;
            Some((by.wall as usize, mass * by.part_along(impulse)))
        })
    };
    for (wall, along) in pushed() {
        driven[wall].now -= driven[wall].response * along;
    }
    for (wall, along) in pushed() {
        works.add_of_driven_wall(0.5 * along * (driven[wall].now - driven[wall].before));
    }
    works.add_of_drives(walls.take_driven(world, &driven));
}
