//! How contacts are found among the candidates.

use std::ops::Range;

use super::contact::Contact;
use super::kept::Kept;
use crate::contact::approach::approach;
use crate::contact::candidates::Candidates;
use crate::contact::numbering::Numbering;
use crate::contact::range::Bond;
use crate::world::World;

/// How contacts are found.
pub(super) struct Search<'a> {
    pub world: &'a World,
    pub candidates: &'a Candidates,
    /// The contacts of the step before.
    pub before: &'a Kept,
    /// Whether pairs with a gap are among the contacts.
    pub looks_ahead: bool,
    pub step: u64,
}

impl Search<'_> {
    /// Finds the contacts of some grains, one after the other.
    #[inline(always)]
    pub(super) fn find<const AXES: usize>(
        &self,
        grains: Range<usize>,
        keep: impl Fn(&Contact, &mut Bond) -> bool,
        now: &mut Kept,
    ) {
        let Self { world, candidates, before: old, looks_ahead, step } = *self;
        let numbering = Numbering::of(world);
        now.clear();
        let mut before =
            old.contacts.partition_point(|contact| (contact.grain as usize) < grains.start);
        for index in grains {
            let (position, radius) = (world.grains.positions[index], world.grains.radii[index]);
            for &other in candidates.of(index) {
                let body = numbering.other(other);
                let Some((normal, gap)) =
                    approach::<AXES>(world, candidates, (position, radius), body)
                else {
                    continue;
                };
                let contact = Contact { grain: index as u32, other, normal, gap };
                // Both lists are sorted alike, so one walk over the old one serves all.
                while before < old.contacts.len() && old.contacts[before].pair() < contact.pair() {
                    before += 1;
                }
                let lives_on =
                    old.contacts.get(before).is_some_and(|then| then.pair() == contact.pair());
                let (impulse, memory, mut bond) = if lives_on {
                    (old.impulses[before], old.memories[before], old.bonds[before])
                } else {
                    Default::default()
                };
                // What only came near so far is found where it touches.
                let was_found = lives_on && (bond.alive || !looks_ahead);
                if !keep(&contact, &mut bond) {
                    continue;
                }
                now.found_in.push(if was_found { old.found_in[before] } else { step });
                now.impulses.push(impulse);
                now.memories.push(memory);
                now.bonds.push(bond);
                now.contacts.push(contact);
            }
        }
    }
}
