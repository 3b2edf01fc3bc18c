//! The contacts of one step. A contact that existed in the step before keeps its impulses.

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

/// Grains whose contacts one thread finds at a time: about a hundred microseconds of work.
const GRAINS_IN_PART: usize = 2048;

/// The contact data that a stepper reads and changes, as separate columns.
pub(crate) struct ContactParts<'a> {
    pub contacts: &'a [Contact],
    pub found_in: &'a [u64],
    pub impulses: &'a mut [Impulse],
    pub memories: &'a mut [ContactMemory],
    pub sums: &'a mut StepSums,
}

/// The contacts of a step, sorted by (i, other), and their impulses. Memory is kept between steps.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContactList {
    now: ContactColumns,
    /// Kept for its memory only: the next step fills it.
    #[serde(skip)]
    before: ContactColumns,
    /// Kept for its memory only: the contacts that each thread finds.
    #[serde(skip)]
    parts: Vec<ContactColumns>,
    /// True if pairs with a gap are among the contacts.
    looks_ahead: bool,
    /// Index of the present step, recorded for contacts found from now on.
    step: u64,
    /// Sums transmitted by pairs in a step that is taken in pieces; empty if the step is taken as a whole.
    sums: StepSums,
    /// True if the present step is summed up.
    #[serde(skip)]
    is_summed_up: bool,
}

impl ContactList {
    /// Sets the index of the step in which contacts are found from now on.
    pub(crate) fn begin_step(&mut self, step: u64) {
        self.step = step;
        self.sums.clear();
        self.is_summed_up = false;
    }

    /// Declares that the step is taken in pieces.
    pub(crate) fn begin_sums(&mut self) {
        self.is_summed_up = true;
    }

    /// Adds the impulses of a piece of the step to the sums.
    pub(crate) fn sum_up(&mut self) {
        if self.is_summed_up {
            for index in 0..self.now.contacts.len() {
                self.add_to_sums(index, self.now.contacts[index].normal, self.now.impulses[index]);
            }
        }
    }

    /// Adds an impulse of a contact along `normal`, which may have turned since the contact was found.
    pub(crate) fn add_to_sums(&mut self, index: usize, normal: DVec2, impulse: Impulse) {
        let ContactColumns { contacts, found_in, .. } = &self.now;
        self.sums.add(Transmitted::of(contacts[index], found_in[index], normal, impulse));
    }

    /// Total impulse transmitted by the pair of a contact in a step that is summed up.
    pub(crate) fn sum_of(&self, contact: &Contact) -> Impulse {
        self.sums.of(contact.pair())
    }

    /// True if the transmitted impulses are those of a whole step, not of its last piece.
    pub(crate) fn has_sums(&self) -> bool {
        !self.sums.pairs.is_empty()
    }

    /// Impulses transmitted in the last step, sorted by pair, each pair once. In a step that is summed up, from the
    /// sums.
    pub(crate) fn transmitted_in_step(&self) -> impl Iterator<Item = Transmitted> + '_ {
        let ContactColumns { contacts, impulses, found_in, .. } = &self.now;
        let is_whole = !self.has_sums();
        let of_contacts = contacts.iter().zip(impulses).zip(found_in).filter(move |_| is_whole);
        let of_contacts = of_contacts.map(|((contact, &impulse), &found_in)| {
            Transmitted::of(*contact, found_in, contact.normal, impulse)
        });
        self.sums.pairs.iter().copied().chain(of_contacts)
    }

    /// Impulses transmitted in the last step, sorted by pair, each with its index among the contacts if it still is a
    /// contact.
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
        // The sort is stable, so the sum of a pair comes first.
        all.sort_by_key(|(pair, _)| pair.contact.pair());
        all.dedup_by(|second, first| {
            let is_same = second.0.contact.pair() == first.0.contact.pair();
            first.1 = if is_same { second.1 } else { first.1 };
            is_same
        });
        all
    }

    /// The contacts, sorted by (i, other).
    pub fn contacts(&self) -> &[Contact] {
        &self.now.contacts
    }

    /// The impulses, one per contact.
    pub fn impulses(&self) -> &[Impulse] {
        &self.now.impulses
    }

    /// Moment impulse that resists rolling, on grain i of a contact, N·m·s.
    pub fn rolling(&self, index: usize) -> f64 {
        self.now.rolling.get(index).copied().unwrap_or(0.0)
    }

    /// Moment impulses that resist rolling, one per contact or none, for the solver to fill in.
    pub(crate) fn rolling_mut(&mut self) -> &mut Vec<f64> {
        &mut self.now.rolling
    }

    /// Mutable impulses, one per contact, for the solver to fill in.
    pub fn impulses_mut(&mut self) -> &mut [Impulse] {
        &mut self.now.impulses
    }

    /// Data kept by the stepper, one per contact.
    pub fn memories(&self) -> &[ContactMemory] {
        &self.now.memories
    }

    /// Contacts and the steps in which they were found, with mutable impulses, memories and sums.
    pub(crate) fn parts_mut(&mut self) -> ContactParts<'_> {
        let ContactColumns { contacts, impulses, memories, found_in, .. } = &mut self.now;
        ContactParts { contacts, found_in, impulses, memories, sums: &mut self.sums }
    }

    /// The step that each contact was first found in.
    pub(crate) fn found_in(&self) -> &[u64] {
        &self.now.found_in
    }

    /// The bonds, one per contact. Only the law `range` gives them meaning.
    pub(crate) fn bonds(&self) -> &[Bond] {
        &self.now.bonds
    }

    /// The bonds, mutable.
    pub(crate) fn bonds_mut(&mut self) -> &mut [Bond] {
        &mut self.now.bonds
    }

    /// True if pairs with a gap are among the contacts.
    pub(crate) fn looks_ahead(&self) -> bool {
        self.looks_ahead
    }

    /// True if the pair of a contact touches or is bonded. False if it is only near.
    pub fn is_in_touch(&self, index: usize) -> bool {
        !self.looks_ahead || self.now.bonds[index].alive
    }

    /// Clears the memories, rolling moments and sums, because the next stepper did not write them.
    pub(crate) fn forget(&mut self) {
        self.now.memories.fill(ContactMemory::default());
        self.now.rolling.clear();
        self.sums.clear();
    }

    /// Multiplies all impulses, so that a change of Δt leaves the forces as they were.
    pub(crate) fn scale_impulses(&mut self, factor: f64) {
        for impulse in &mut self.now.impulses {
            impulse.normal *= factor;
            impulse.tangential *= factor;
        }
        self.now.rolling.iter_mut().for_each(|impulse| *impulse *= factor);
    }

    /// Removes the contacts of a body, and decreases the indices above it by one.
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

    /// The contacts, and the contacts recorded in the step's sums.
    fn all_mut(&mut self) -> impl Iterator<Item = &mut Contact> {
        let earlier = self.sums.pairs.iter_mut().map(|pair| &mut pair.contact);
        self.now.contacts.iter_mut().chain(earlier)
    }

    /// Makes room for a new body with index `body`, which touches no other yet.
    pub(crate) fn insert_body(&mut self, body: u32) {
        for contact in self.all_mut() {
            contact.grain += u32::from(contact.grain >= body);
            contact.other += u32::from(contact.other >= body);
        }
    }

    /// True if all lists have the same length and refer to existing bodies. There are `bodies` bodies, the first
    /// `grains` of which are grains.
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

    /// Finds the contacts at the present positions: candidates with a gap below the tolerance. A contact that existed
    /// in the step before starts from its previous impulses and memory, any other from 0.
    pub fn detect<const AXES: usize>(&mut self, world: &World, candidates: &Candidates) {
        self.looks_ahead = false;
        let gap_tolerance = candidates.gap_tolerance();
        self.find::<AXES>(world, candidates, |contact, _| contact.gap < gap_tolerance);
    }

    /// Finds the pairs that touch, are bonded, or may touch within the step.
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

    /// Takes the candidates for which `keep` returns true, given the contact and its bond.
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

    /// Separates bodies that overlap by more than `allowed` (m), pair by pair. Each grain of a pair moves in
    /// proportion to the other's mass. Velocities, and so the kinetic energy, stay the same. Returns true if there
    /// were any such overlaps: one pass may open one pair and close the next.
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

/// Data kept of contacts from one step to the next, as columns.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ContactColumns {
    contacts: Vec<Contact>,
    impulses: Vec<Impulse>,
    memories: Vec<ContactMemory>,
    bonds: Vec<Bond>,
    /// The step in which each contact was first found.
    found_in: Vec<u64>,
    /// Moment impulses on i that resist rolling, N·m·s; empty if no contact does.
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

    /// Replaces the contents by the concatenation of `parts`.
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
    /// The contacts of the step before.
    before: &'a ContactColumns,
    /// True if pairs with a gap are among the contacts.
    looks_ahead: bool,
    step: u64,
}

impl ContactSearch<'_> {
    /// Finds the contacts of a range of grains, in order.
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
                // Both lists have the same order, so one walk over the old list suffices.
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
                // A pair that only came near so far counts as found when it touches.
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
