//! The contacts of one step, with the impulses of the step before where a contact lives on.

mod contact;
mod kept;
mod search;

use glam::DVec2;
use rayon::iter::{IndexedParallelIterator, IntoParallelRefMutIterator, ParallelIterator};
use serde::{Deserialize, Serialize};

pub use self::contact::{Contact, ContactMemory, Impulse};
use self::kept::Kept;
use self::search::Search;
use super::candidates::Candidates;
use super::look_ahead::LookAhead;
use super::numbering::{Numbering, Other};
use super::range::Bond;
use crate::threads;
use crate::world::World;

/// Grains whose contacts one thread finds at a time: a hundred microseconds of work.
const GRAINS_IN_PART: usize = 2048;

/// The contacts of a step, sorted by (i, other), and their impulses. Memory is kept between steps.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContactList {
    now: Kept,
    /// Memory alone: the next step fills it.
    #[serde(skip)]
    before: Kept,
    /// Memory alone: what threads find, each of some grains.
    #[serde(skip)]
    parts: Vec<Kept>,
    /// Whether pairs with a gap are among the contacts.
    looks_ahead: bool,
    /// The step that contacts are found in from now on.
    step: u64,
}

impl ContactList {
    /// Says which step contacts are found in from now on.
    pub(crate) fn begin_step(&mut self, step: u64) {
        self.step = step;
    }

    /// How many steps ago each pair was found to touch, or to be bonded, that has done so ever since, one
    /// a contact; 0 where that was in the last step.
    pub fn ages(&self) -> impl ExactSizeIterator<Item = u64> + '_ {
        self.now.found_in.iter().map(|&found_in| self.step - found_in)
    }

    /// Whether no step has been solved with a contact yet. Those that a run begins with were found before its
    /// first step, and a pair that touches is found once, however often its step is cut.
    pub(crate) fn is_unsolved(&self, index: usize) -> bool {
        let is_young = self.step <= 1 || self.now.found_in[index] == self.step;
        is_young && self.now.impulses[index] == Impulse::default()
    }

    /// The contacts, sorted by (i, other).
    pub fn contacts(&self) -> &[Contact] {
        &self.now.contacts
    }

    /// The impulses, one a contact.
    pub fn impulses(&self) -> &[Impulse] {
        &self.now.impulses
    }

    /// The impulses, one a contact, to be filled in by the solver.
    pub fn impulses_mut(&mut self) -> &mut [Impulse] {
        &mut self.now.impulses
    }

    /// What a stepping scheme keeps, one a contact.
    pub fn memories(&self) -> &[ContactMemory] {
        &self.now.memories
    }

    /// The contacts, with impulses and memories to be changed, one a contact.
    pub(crate) fn parts_mut(&mut self) -> (&[Contact], &mut [Impulse], &mut [ContactMemory]) {
        let Kept { contacts, impulses, memories, .. } = &mut self.now;
        (contacts, impulses, memories)
    }

    /// The contacts with their bonds, one a contact; they mean something under the law `range` alone.
    pub(crate) fn bonds(&self) -> &[Bond] {
        &self.now.bonds
    }

    /// The bonds, to be changed.
    pub(crate) fn bonds_mut(&mut self) -> &mut [Bond] {
        &mut self.now.bonds
    }

    /// Whether pairs with a gap are among the contacts.
    pub(crate) fn looks_ahead(&self) -> bool {
        self.looks_ahead
    }

    /// Whether the pair of a contact touches or is bonded, and does not just come near.
    pub fn is_in_touch(&self, index: usize) -> bool {
        !self.looks_ahead || self.now.bonds[index].alive
    }

    /// Empties the memories: what comes next was not prepared by the scheme that filled them.
    pub(crate) fn forget(&mut self) {
        self.now.memories.fill(ContactMemory::default());
    }

    /// Multiplies all impulses, so that a change of Δt leaves the forces as they were.
    pub(crate) fn scale_impulses(&mut self, factor: f64) {
        for impulse in &mut self.now.impulses {
            impulse.normal *= factor;
            impulse.tangential *= factor;
        }
    }

    /// Drops the contacts of a body, and numbers those after it one lower.
    pub(crate) fn remove_body(&mut self, body: u32) {
        let Kept { contacts, impulses, memories, bonds, found_in } = &mut self.now;
        let stays = |contact: &Contact| contact.grain != body && contact.other != body;
        let stay = contacts.iter().map(stays).collect::<Vec<_>>().into_iter();
        let [mut of_impulses, mut of_memories, mut of_bonds, mut of_steps] =
            [(); 4].map(|()| stay.clone());
        impulses.retain(|_| of_impulses.next() == Some(true));
        memories.retain(|_| of_memories.next() == Some(true));
        bonds.retain(|_| of_bonds.next() == Some(true));
        found_in.retain(|_| of_steps.next() == Some(true));
        contacts.retain(stays);
        for contact in contacts {
            contact.grain -= u32::from(contact.grain > body);
            contact.other -= u32::from(contact.other > body);
        }
    }

    /// Makes room among the bodies for one more of that number, which touches none yet.
    pub(crate) fn insert_body(&mut self, body: u32) {
        for contact in &mut self.now.contacts {
            contact.grain += u32::from(contact.grain >= body);
            contact.other += u32::from(contact.other >= body);
        }
    }

    /// Whether its lists are of one length and tell of bodies that exist, of which there are so many, the
    /// first of them grains.
    pub(crate) fn is_sound(&self, bodies: usize, grains: usize) -> bool {
        let Kept { contacts, impulses, memories, bonds, found_in } = &self.now;
        let lengths = [impulses.len(), memories.len(), bonds.len(), found_in.len()];
        let is_past = |&step: &u64| step <= self.step;
        let exists = |contact: &Contact| {
            (contact.grain as usize) < grains && (contact.other as usize) < bodies
        };
        lengths == [contacts.len(); 4]
            && contacts.iter().all(exists)
            && found_in.iter().all(is_past)
    }

    /// Finds the contacts at the present positions: candidates with a gap below the tolerance. A
    /// contact that was there the step before starts from its impulses and its memory of then, any
    /// other from 0.
    pub fn detect<const AXES: usize>(&mut self, world: &World, candidates: &Candidates) {
        self.looks_ahead = false;
        let gap_tolerance = candidates.gap_tolerance();
        self.find::<AXES>(world, candidates, |contact, _| contact.gap < gap_tolerance);
    }

    /// Finds the pairs that touch, that are bonded, or that may come to touch within the step.
    pub(crate) fn detect_ahead<const AXES: usize>(
        &mut self,
        world: &World,
        candidates: &Candidates,
        ahead: LookAhead,
    ) {
        self.looks_ahead = true;
        let gap_tolerance = candidates.gap_tolerance();
        let numbering = Numbering::of(world);
        let velocities = &world.grains.velocities;
        self.find::<AXES>(world, candidates, |contact, bond| {
            let gap = contact.gap;
            if !ahead.bonds {
                *bond = Bond { alive: gap < gap_tolerance, stretch: 0.0 };
            } else if gap <= gap_tolerance && !bond.alive {
                *bond = Bond { alive: true, stretch: 0.0 };
            }
            if bond.alive {
                return true;
            }
            let i = contact.grain as usize;
            let other = match numbering.other(contact.other) {
                Other::Grain(j) => velocities[j] + world.speed_of_image(i, j) * DVec2::X,
                Other::FixedDisc(_) | Other::Feature(_) => DVec2::ZERO,
            };
            let opening = contact.normal.dot(velocities[i] - other);
            gap < ahead.reach && gap + ahead.time_step_secs * opening.min(0.0) < ahead.distance
        });
    }

    /// Takes the candidates of which `keep` says, by normal, gap and bond, that they are contacts.
    #[inline(always)]
    fn find<const AXES: usize>(
        &mut self,
        world: &World,
        candidates: &Candidates,
        keep: impl Fn(&Contact, &mut Bond) -> bool + Sync,
    ) {
        std::mem::swap(&mut self.now, &mut self.before);
        let Self { now, before, parts, looks_ahead, step } = self;
        let search = Search { world, candidates, before, looks_ahead: *looks_ahead, step: *step };
        let grains = world.grains.len();
        if grains <= GRAINS_IN_PART || !threads::are_there() {
            return search.find::<AXES>(0..grains, &keep, now);
        }
        parts.resize_with(grains.div_ceil(GRAINS_IN_PART), Kept::default);
        parts.par_iter_mut().enumerate().for_each(|(number, part)| {
            let first = number * GRAINS_IN_PART;
            search.find::<AXES>(first..grains.min(first + GRAINS_IN_PART), &keep, part);
        });
        now.take_all(parts);
    }
}
