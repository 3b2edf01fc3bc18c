//! Impulses transmitted by pairs in a step that is taken in pieces. Each piece finds its contacts again and turns
//! their normals.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::pair::{Contact, Impulse};

/// Impulses transmitted by a pair since the step began.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Transmitted {
    /// The contact as it was first found in the step.
    pub contact: Contact,
    /// The step in which it was found to touch.
    pub found_in: u64,
    /// Sums along the normals and tangents of the time, N·s.
    pub sums: Impulse,
    /// Sum as a vector on grain i, N·s.
    pub vector: DVec2,
}

impl Transmitted {
    /// The impulse of one contact along `normal`.
    pub(crate) fn of(contact: Contact, found_in: u64, normal: DVec2, impulse: Impulse) -> Self {
        let vector = impulse.normal * normal + impulse.tangential * normal.perp();
        Self { contact, found_in, sums: impulse, vector }
    }
}

/// Transmitted impulses of a step, sorted like contacts.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct StepSums {
    pub(super) pairs: Vec<Transmitted>,
    /// Index at which the next pair is looked for first, because pairs come in list order except in shocks.
    #[serde(skip)]
    next: usize,
}

impl StepSums {
    pub(super) fn clear(&mut self) {
        self.pairs.clear();
        self.next = 0;
    }

    /// Total impulse transmitted by a pair.
    pub(super) fn of(&self, pair: (u32, u32)) -> Impulse {
        self.place_of(pair).map_or_else(|_| Impulse::default(), |place| self.pairs[place].sums)
    }

    fn place_of(&self, pair: (u32, u32)) -> Result<usize, usize> {
        self.pairs.binary_search_by_key(&pair, |there| there.contact.pair())
    }

    /// Adds to the total of a pair.
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
