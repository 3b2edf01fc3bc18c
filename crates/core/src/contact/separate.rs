//! Grains that overlap, moved apart.

use super::approach::approach;
use super::candidates::Candidates;
use super::contact_list::ContactList;
use super::numbering::{Numbering, Other};
use crate::world::World;

impl ContactList {
    /// Moves grains that overlap by more than `allowed` (m) apart, pair by pair, each grain by the
    /// other's share of the mass. Velocities, and so kinetic energy, stay as they are. Whether there
    /// were any: one pass opens a pair and may close the next.
    pub(crate) fn separate<const AXES: usize>(
        &self,
        world: &mut World,
        candidates: &Candidates,
        allowed: f64,
    ) -> bool {
        let mut found = false;
        let numbering = Numbering::of(world);
        for contact in self.contacts() {
            let (i, other) = (contact.grain as usize, numbering.other(contact.other));
            let disc = (world.grains.positions[i], world.grains.radii[i]);
            let Some((normal, gap)) = approach::<AXES>(world, candidates, disc, other) else {
                continue;
            };
            if gap >= -allowed {
                continue;
            }
            found = true;
            let push = -gap * normal;
            let grains = &mut world.grains;
            if let Other::Grain(j) = other {
                let share = grains.masses[j] / (grains.masses[i] + grains.masses[j]);
                grains.positions[i] += share * push;
                grains.positions[j] -= (1.0 - share) * push;
            } else {
                grains.positions[i] += push;
            }
        }
        found
    }
}
