//! Sums of the contact impulses between pairs of bodies over a step that is divided into shorter steps (pieces). The
//! contacts are found again in each piece, and their normals turn from piece to piece, so the impulses must be added
//! up as vectors, too.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::pair::{Contact, Impulse};

/// The contact impulses between two bodies, summed since the step began.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Transmitted {
    /// The contact as it was first found in the step.
    pub contact: Contact,
    /// Index of the step in which the two bodies were first found to touch.
    pub found_in: u64,
    /// Sums of the normal and of the tangential impulses, N·s. Each impulse is measured along the normal or tangent
    /// that the contact had when the impulse acted.
    pub sums: Impulse,
    /// Sum of the impulse vectors that act on the first body of the contact, which is a grain, N·s.
    pub vector: DVec2,
}

impl Transmitted {
    /// Returns the impulse sums of a pair of bodies with a single impulse (N·s) of their contact: its normal and
    /// tangential component, and its vector for the given unit normal.
    pub(crate) fn of(contact: Contact, found_in: u64, normal: DVec2, impulse: Impulse) -> Self {
        let vector = impulse.normal * normal + impulse.tangential * normal.perp();
        Self { contact, found_in, sums: impulse, vector }
    }
}

/// The sums of the contact impulses over a step, with one entry per pair of bodies, sorted by the index of the grain
/// and then of the other body.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct StepSums {
    pub(super) pairs: Vec<Transmitted>,
    /// Index at which [`Self::add`] looks first for the pair of the next impulse. Except in collisions, impulses are
    /// added in the order of the list, so this index is usually right.
    #[serde(skip)]
    next: usize,
}

impl StepSums {
    pub(super) fn clear(&mut self) {
        self.pairs.clear();
        self.next = 0;
    }

    /// Returns the total impulse between two bodies in the step, zero if the pair is not in the list.
    pub(super) fn of(&self, pair: (u32, u32)) -> Impulse {
        self.place_of(pair).map_or_else(|_| Impulse::default(), |place| self.pairs[place].sums)
    }

    fn place_of(&self, pair: (u32, u32)) -> Result<usize, usize> {
        self.pairs.binary_search_by_key(&pair, |there| there.contact.pair())
    }

    /// Adds the impulse of a contact to the sums of its two bodies.
    pub(crate) fn add(&mut self, added: Transmitted) {
        let pair = added.contact.pair();
        let at_next = self.pairs.get(self.next).map(|there| there.contact.pair());
        let place = if at_next == Some(pair) { Ok(self.next) } else { self.place_of(pair) };
        match place {
            Ok(place) => {
                let there = &mut self.pairs[place];
                there.sums.normal += added.sums.normal;
                there.sums.tangential += added.sums.tangential;
                there.vector += added.vector;
            }
            Err(place) => self.pairs.insert(place, added),
        }
        self.next = place.unwrap_or_else(|place| place) + 1;
    }
}
