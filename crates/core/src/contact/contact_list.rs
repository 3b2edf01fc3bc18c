//! The list of the contacts of one step. A contact that existed in the previous step starts with its previous
//! impulses.

use std::ops::Range;

use glam::DVec2;
use rayon::iter::{IndexedParallelIterator, IntoParallelRefMutIterator, ParallelIterator};
use serde::{Deserialize, Serialize};

use super::approach::{InTouch, LookAhead, approach};
use super::candidates::Candidates;
use super::numbering::{Numbering, Other};
use super::pair::{Contact, ContactMemory, Impulse};
use super::range::Bond;
use super::transmitted::{StepSums, Transmitted};
use crate::number::Parts;
use crate::threads;
use crate::world::World;

/// Number of grains whose contacts one thread finds at a time, in about a hundred microseconds. With fewer grains, the
/// distribution of the work costs more; with more, threads are idle at the end.
const GRAINS_IN_PART: usize = 2048;

/// The columns (arrays with one entry per contact) of a [`ContactList`] that a stepper reads or changes.
pub(crate) struct ContactParts<'a> {
    pub contacts: &'a [Contact],
    pub found_in: &'a [u64],
    pub impulses: &'a mut [Impulse],
    pub memories: &'a mut [ContactMemory],
    pub sums: &'a mut StepSums,
}

/// The contacts of a step, sorted by the index of the grain and then of the other body, with their impulses and other
/// data. Each quantity has its own array (column) with one entry per contact. The list keeps its allocated memory from
/// step to step.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContactList {
    now: ContactColumns,
    /// The contacts of the previous step, while the contacts of the present step are searched for. After the search
    /// only the allocated memory of this field is used.
    #[serde(skip)]
    before: ContactColumns,
    /// The contacts that each thread has found, before they are joined to one list. Kept between steps for the
    /// allocated memory only.
    #[serde(skip)]
    parts: Vec<ContactColumns>,
    /// True if the list also contains pairs of bodies that do not touch yet but may touch within the step.
    looks_ahead: bool,
    /// Index of the present step. It is stored with each contact that is new in this step.
    step: u64,
    /// For each pair of bodies, the sum of its contact impulses over a step that is divided into shorter steps
    /// (pieces). Empty if the step is undivided.
    sums: StepSums,
    /// True if the contact impulses of the present step are summed, because the step is divided into shorter steps
    /// (pieces).
    #[serde(skip)]
    is_summed_up: bool,
}

impl ContactList {
    /// Begins the step with this index. The index is stored with each contact that is new in this step. The impulse
    /// sums of the previous step are cleared.
    pub(crate) fn begin_step(&mut self, step: u64) {
        self.step = step;
        self.sums.clear();
        self.is_summed_up = false;
    }

    /// Declares that the present step is divided into shorter steps (pieces), so that the contact impulses of the
    /// pieces are summed.
    pub(crate) fn begin_sums(&mut self) {
        self.is_summed_up = true;
    }

    /// Adds the contact impulses of the present piece to the sums over the step, if the step is divided into shorter
    /// steps (pieces). Does nothing in an undivided step.
    pub(crate) fn sum_up(&mut self) {
        if self.is_summed_up {
            for index in 0..self.now.contacts.len() {
                self.add_to_sums(index, self.now.contacts[index].normal, self.now.impulses[index]);
            }
        }
    }

    /// Adds an impulse (N·s) of the contact with this index to the impulse sums of the step. Its normal component acts
    /// along `normal`, which may have turned since the contact was found.
    pub(crate) fn add_to_sums(&mut self, index: usize, normal: DVec2, impulse: Impulse) {
        let ContactColumns { contacts, found_in, .. } = &self.now;
        self.sums.add(Transmitted::of(contacts[index], found_in[index], normal, impulse));
    }

    /// Returns the total impulse between the two bodies of a contact in the present step, which is divided into
    /// shorter steps (pieces).
    pub(crate) fn sum_of(&self, contact: &Contact) -> Impulse {
        self.sums.of(contact.pair())
    }

    /// True if the step is divided into shorter steps (pieces) and impulse sums over the pieces exist. Then the sums
    /// belong to the whole step, and the impulses in the list only to its last piece.
    pub(crate) fn has_sums(&self) -> bool {
        !self.sums.pairs.is_empty()
    }

    /// Returns the contact impulses of the last step, one entry per pair of bodies, sorted by pair. If the step was
    /// divided into shorter steps (pieces), these are the sums over the pieces.
    pub(crate) fn transmitted_in_step(&self) -> impl Iterator<Item = Transmitted> + '_ {
        let ContactColumns { contacts, impulses, found_in, .. } = &self.now;
        let is_whole = !self.has_sums();
        let of_contacts = contacts.iter().zip(impulses).zip(found_in).filter(move |_| is_whole);
        let of_contacts = of_contacts.map(|((contact, &impulse), &found_in)| {
            Transmitted::of(*contact, found_in, contact.normal, impulse)
        });
        self.sums.pairs.iter().copied().chain(of_contacts)
    }

    /// Returns the contact impulses of the last step, one entry per pair of bodies, sorted by pair. The second item of
    /// an entry is the index of the contact in the list, or `None` if the pair is no longer in the list.
    pub(crate) fn transmitted(&self) -> Vec<(Transmitted, Option<usize>)> {
        let ContactColumns { contacts, impulses, found_in, .. } = &self.now;
        let whole = !self.has_sums();
        let of_contact = |(index, (contact, impulse)): (usize, (&Contact, &Impulse))| {
            let impulse = if whole { *impulse } else { Impulse::default() };
            let pair = Transmitted::of(*contact, found_in[index], contact.normal, impulse);
            (pair, Some(index))
        };
        let of_contacts = contacts.iter().zip(impulses).enumerate().map(of_contact);
        let sums = self.sums.pairs.iter().map(|pair| (*pair, None));
        let mut all: Vec<_> = sums.chain(of_contacts).collect();
        // The sort is stable, so the summed impulse of a pair comes before the impulse of its last piece.
        all.sort_by_key(|(pair, _)| pair.contact.pair());
        all.dedup_by(|second, first| {
            let is_same = second.0.contact.pair() == first.0.contact.pair();
            first.1 = if is_same { second.1 } else { first.1 };
            is_same
        });
        all
    }

    /// The contacts, sorted by the index of the grain and then by the index of the other body.
    pub fn contacts(&self) -> &[Contact] {
        &self.now.contacts
    }

    /// The impulses of the contacts, N·s, in the order of [`Self::contacts`].
    pub fn impulses(&self) -> &[Impulse] {
        &self.now.impulses
    }

    /// Rolling impulse of the contact with this index, N·m·s: the time integral over the step of the moment that
    /// resists rolling, as it acts on the first body of the contact.
    pub fn rolling(&self, index: usize) -> f64 {
        self.now.rolling.get(index).copied().unwrap_or(0.0)
    }

    /// Rolling impulses, N·m·s: time integrals over the step of the moments that resist rolling, for the solver to
    /// fill in. The list has one number per contact, or is empty without rolling friction.
    pub(crate) fn rolling_mut(&mut self) -> &mut Vec<f64> {
        &mut self.now.rolling
    }

    /// The impulses of the contacts, N·s, one per contact, for the solver to fill in.
    pub fn impulses_mut(&mut self) -> &mut [Impulse] {
        &mut self.now.impulses
    }

    /// Data that the stepper keeps about each contact from one step to the next, one entry per contact.
    pub fn memories(&self) -> &[ContactMemory] {
        &self.now.memories
    }

    /// Returns the contacts and the steps in which they were found, and mutable references to their impulses, stepper
    /// data and impulse sums.
    pub(crate) fn parts_mut(&mut self) -> ContactParts<'_> {
        let ContactColumns { contacts, impulses, memories, found_in, .. } = &mut self.now;
        ContactParts { contacts, found_in, impulses, memories, sums: &mut self.sums }
    }

    /// For each contact, the index of the step in which it was first found.
    pub(crate) fn found_in(&self) -> &[u64] {
        &self.now.found_in
    }

    /// State of the bond of each contact: whether the bond exists, and its stretch. Up to date only if the search for
    /// contacts also included pairs that do not touch yet, because a search for touching pairs only does not change the
    /// states. Under the law `range` it always includes them.
    pub(crate) fn bonds(&self) -> &[Bond] {
        &self.now.bonds
    }

    /// State of the bond of each contact (whether the bond exists, and its stretch), for the stepper to change.
    pub(crate) fn bonds_mut(&mut self) -> &mut [Bond] {
        &mut self.now.bonds
    }

    /// True if the list also contains pairs of bodies that do not touch yet but may touch within the step.
    pub(crate) fn looks_ahead(&self) -> bool {
        self.looks_ahead
    }

    /// True if the two bodies of the contact with this index touch or are bonded. False if they are only near each
    /// other.
    pub fn is_in_touch(&self, index: usize) -> bool {
        !self.looks_ahead || self.now.bonds[index].alive
    }

    /// Clears the data that the stepper keeps about contacts, the rolling impulses, and the impulse sums of the step.
    /// Called when the stepper changes, because the new stepper did not write these data.
    pub(crate) fn forget(&mut self) {
        self.now.memories.fill(ContactMemory::default());
        self.now.rolling.clear();
        self.sums.clear();
    }

    /// Multiplies all impulses by `factor`. If the factor is the ratio of the new to the old time step, the contact
    /// forces stay the same.
    pub(crate) fn scale_impulses(&mut self, factor: f64) {
        for impulse in &mut self.now.impulses {
            impulse.normal *= factor;
            impulse.tangential *= factor;
        }
        self.now.rolling.iter_mut().for_each(|impulse| *impulse *= factor);
    }

    /// Removes the contacts of a body that is removed from the world, and decreases all body indices above `body` by
    /// one.
    pub(crate) fn remove_body(&mut self, body: u32) {
        let ContactColumns { contacts, impulses, memories, bonds, found_in, rolling } =
            &mut self.now;
        let stays = |contact: &Contact| contact.grain != body && contact.other != body;
        let stay = contacts.iter().map(stays).collect::<Vec<_>>().into_iter();
        let [mut of_impulses, mut of_memories, mut of_bonds, mut of_steps, mut of_rolling] =
            [(); 5].map(|()| stay.clone());
        impulses.retain(|_| of_impulses.next() == Some(true));
        memories.retain(|_| of_memories.next() == Some(true));
        bonds.retain(|_| of_bonds.next() == Some(true));
        found_in.retain(|_| of_steps.next() == Some(true));
        rolling.retain(|_| of_rolling.next() == Some(true));
        contacts.retain(stays);
        self.sums.pairs.retain(|pair| stays(&pair.contact));
        for contact in self.all_mut() {
            contact.grain -= u32::from(contact.grain > body);
            contact.other -= u32::from(contact.other > body);
        }
    }

    /// Iterates over the contacts of the list and over those whose impulses are summed over the step.
    fn all_mut(&mut self) -> impl Iterator<Item = &mut Contact> {
        let earlier = self.sums.pairs.iter_mut().map(|pair| &mut pair.contact);
        self.now.contacts.iter_mut().chain(earlier)
    }

    /// Increases all body indices from `body` on by one, so that a new body, which has no contacts yet, can have the
    /// index `body`.
    pub(crate) fn insert_body(&mut self, body: u32) {
        for contact in self.all_mut() {
            contact.grain += u32::from(contact.grain >= body);
            contact.other += u32::from(contact.other >= body);
        }
    }

    /// Returns true if the list is consistent: all columns have the same length, all body indices refer to existing
    /// bodies, and no contact was found after the present step. `bodies` is the number of all bodies, and the first
    /// `grains` of them are grains.
    pub(crate) fn is_sound(&self, bodies: usize, grains: usize) -> bool {
        let ContactColumns { contacts, impulses, memories, bonds, found_in, rolling } = &self.now;
        let lengths = [impulses.len(), memories.len(), bonds.len(), found_in.len()];
        let is_past = |&step: &u64| step <= self.step;
        let exists = |contact: &Contact| {
            (contact.grain as usize) < grains && (contact.other as usize) < bodies
        };
        lengths == [contacts.len(); 4]
            && (rolling.is_empty() || rolling.len() == contacts.len())
            && contacts.iter().chain(self.sums.pairs.iter().map(|pair| &pair.contact)).all(exists)
            && found_in.iter().all(is_past)
    }

    /// Finds the contacts at the present positions: pairs of nearby bodies (`candidates`) with a gap below the gap
    /// tolerance (the largest gap of a touching pair). A contact that existed in the previous step starts with its
    /// previous impulses and stepper data. All other contacts start with zero.
    pub fn detect<const AXES: usize>(&mut self, world: &World, candidates: &Candidates) {
        self.looks_ahead = false;
        let gap_tolerance = candidates.gap_tolerance();
        self.find::<AXES>(world, candidates, |contact, _| contact.gap < gap_tolerance);
    }

    /// Finds the contacts of a step, including pairs that do not touch yet: pairs that touch, are bonded, or may touch
    /// within the step. `normal_velocity_of_wall` returns the velocity (m/s) of the wall or fixed disc of a contact
    /// along the normal.
    pub(crate) fn detect_ahead<const AXES: usize>(
        &mut self,
        world: &World,
        candidates: &Candidates,
        ahead: LookAhead,
        normal_velocity_of_wall: impl Fn(&Contact) -> f64 + Sync,
    ) {
        self.looks_ahead = true;
        let gap_tolerance = candidates.gap_tolerance();
        let numbering = Numbering::of(world);
        let velocities = &world.grains.velocities;
        self.find::<AXES>(world, candidates, |contact, bond| {
            let gap = contact.gap;
            match ahead.in_touch {
                InTouch::Touching => *bond = Bond { alive: gap < gap_tolerance, stretch: 0.0 },
                InTouch::Within(most) => *bond = Bond { alive: gap <= most, stretch: 0.0 },
                InTouch::Bonded if gap <= gap_tolerance && !bond.alive => {
                    *bond = Bond { alive: true, stretch: 0.0 };
                }
                InTouch::Bonded => (),
            }
            if bond.alive {
                return true;
            }
            let i = contact.grain as usize;
            let opening = match numbering.other(contact.other) {
                Other::Grain(j) => {
                    let other = velocities[j] + world.speed_of_image(i, j) * DVec2::X;
                    contact.normal.dot(velocities[i] - other)
                }
                Other::FixedDisc(_) | Other::Feature(_) => {
                    contact.normal.dot(velocities[i]) - normal_velocity_of_wall(contact)
                }
            };
            gap < ahead.reach
                && gap + ahead.time_step_secs * opening.negative_part() < ahead.distance
        });
    }

    /// Replaces the contacts by all pairs of nearby bodies (`candidates`) for which `keep` returns true. `keep`
    /// receives the contact and the state of its bond, which it may change.
    #[inline(always)]
    fn find<const AXES: usize>(
        &mut self,
        world: &World,
        candidates: &Candidates,
        keep: impl Fn(&Contact, &mut Bond) -> bool + Sync,
    ) {
        std::mem::swap(&mut self.now, &mut self.before);
        let Self { now, before, parts, looks_ahead, step, .. } = self;
        let search =
            ContactSearch { world, candidates, before, looks_ahead: *looks_ahead, step: *step };
        let grains = world.grains.len();
        if grains <= GRAINS_IN_PART || !threads::are_there() {
            return search.find::<AXES>(0..grains, &keep, now);
        }
        parts.resize_with(grains.div_ceil(GRAINS_IN_PART), ContactColumns::default);
        parts.par_iter_mut().enumerate().for_each(|(number, part)| {
            let first = number * GRAINS_IN_PART;
            search.find::<AXES>(first..grains.min(first + GRAINS_IN_PART), &keep, part);
        });
        now.take_all(parts);
    }

    /// Separates bodies that overlap by more than `allowed` (m), one pair after the other. Of two grains each moves in
    /// proportion to the mass of the other; a wall or fixed disc does not move. Velocities, and so the kinetic energy,
    /// stay the same. Returns true if any overlap was larger than `allowed`. Then another pass may be needed, because
    /// separating one pair may push others together.
    pub(crate) fn separate(
        &self,
        world: &mut World,
        candidates: &Candidates,
        allowed: f64,
        axes: usize,
    ) -> bool {
        let mut found = false;
        let numbering = Numbering::of(world);
        for contact in self.contacts() {
            let (i, other) = (contact.grain as usize, numbering.other(contact.other));
            let (place, radius) = (world.grains.positions[i], world.grains.radii[i]);
            let found_gap = approach(world, candidates, place, radius, other, axes);
            let Some((normal, gap)) = found_gap else { continue };
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

/// Contact data that is kept from one step to the next, as columns with one entry per contact.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ContactColumns {
    contacts: Vec<Contact>,
    impulses: Vec<Impulse>,
    memories: Vec<ContactMemory>,
    bonds: Vec<Bond>,
    /// For each contact, the index of the step in which it was first found.
    found_in: Vec<u64>,
    /// Rolling impulses, N·m·s: time integrals over the step of the moments that resist rolling, as they act on the
    /// first body of each contact. Empty without rolling friction.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    rolling: Vec<f64>,
}

impl ContactColumns {
    fn clear(&mut self) {
        let Self { contacts, impulses, memories, bonds, found_in, rolling } = self;
        contacts.clear();
        impulses.clear();
        memories.clear();
        bonds.clear();
        found_in.clear();
        rolling.clear();
    }

    /// Replaces all entries by the entries of the lists in `parts`, joined in order.
    fn take_all(&mut self, parts: &[Self]) {
        fn join<'a, T: Copy + 'a>(all: &mut Vec<T>, parts: impl Iterator<Item = &'a Vec<T>>) {
            parts.for_each(|part| all.extend_from_slice(part));
        }
        self.clear();
        let Self { contacts, impulses, memories, bonds, found_in, rolling } = self;
        let parts = || parts.iter();
        rayon::join(
            || {
                join(contacts, parts().map(|part| &part.contacts));
                join(bonds, parts().map(|part| &part.bonds));
            },
            || {
                join(memories, parts().map(|part| &part.memories));
                join(impulses, parts().map(|part| &part.impulses));
                join(found_in, parts().map(|part| &part.found_in));
                join(rolling, parts().map(|part| &part.rolling));
            },
        );
    }
}

/// Inputs of the search for contacts.
struct ContactSearch<'a> {
    world: &'a World,
    candidates: &'a Candidates,
    /// The contacts of the previous step.
    before: &'a ContactColumns,
    /// True if pairs of bodies that do not touch yet, but may touch within the step, are also searched for.
    looks_ahead: bool,
    step: u64,
}

impl ContactSearch<'_> {
    /// Writes the contacts of a range of grains to `now`, sorted by the indices of their bodies.
    #[inline(always)]
    fn find<const AXES: usize>(
        &self,
        grains: Range<usize>,
        keep: impl Fn(&Contact, &mut Bond) -> bool,
        now: &mut ContactColumns,
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
                let found = approach(world, candidates, position, radius, body, AXES);
                let Some((normal, gap)) = found else { continue };
                let contact = Contact { grain: index as u32, other, normal, gap };
                // Both lists are sorted by pair, so one pass over the old list suffices.
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
                // If pairs with a gap are in the list, a contact counts as found in the step in which it first
                // touches.
                let was_found = lives_on && (bond.alive || !looks_ahead);
                if !keep(&contact, &mut bond) {
                    continue;
                }
                if !old.rolling.is_empty() {
                    now.rolling.push(if lives_on { old.rolling[before] } else { 0.0 });
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
