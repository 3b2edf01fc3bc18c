//! In which order a sweep visits the contacts.
//!
//! Whatever the order, contacts with fixed bodies come first, then those between grains, so that
//! each kind has a loop of its own; an order is one within each kind.

use crate::contact::{Contact, Numbering};
use crate::solver::ordering::Ordering;
use crate::world::World;

/// Stretches that the order of detection is cut into when it is interleaved. Neighbours in the order
/// of detection share a grain, so each update would wait for the one before it to finish; interleaved,
/// updates in flight touch different grains. With fewer, updates wait for each other; with many more,
/// a sweep over a large pile loses its locality in the cache. Up to this many contacts of a kind the
/// two orders are the same.
const STREAMS: usize = 8;

/// Colours that a grain keeps account of. Contacts that find none free, on a grain with more
/// neighbours than that, get a colour each.
const COLOURS: u32 = u128::BITS;

/// Sorts contacts. Memory is kept between steps.
#[derive(Clone, Debug, Default)]
pub(super) struct Sorter {
    detected: Vec<u32>,
    keys: Vec<(f64, u32)>,
    colours: Vec<(u32, u32)>,
    /// The colours that each grain has, one bit each.
    taken: Vec<u128>,
}

impl Sorter {
    /// Appends the contacts `numbers` of one kind, given in the order of detection, to `rows`. Where
    /// they are coloured, `ends` gets the end of each colour among what was appended.
    pub(super) fn append(
        &mut self,
        ordering: Ordering,
        (world, contacts): (&World, &[Contact]),
        numbers: impl Iterator<Item = u32>,
        rows: &mut Vec<u32>,
        ends: &mut Vec<usize>,
    ) {
        self.begin(numbers, ends);
        match ordering {
            Ordering::Detected => rows.extend(&self.detected),
            Ordering::Interleaved | Ordering::Symmetric => self.interleave(rows),
            Ordering::BottomUp => self.sort_by_height(world, contacts, rows),
            Ordering::Coloured => self.colour(world.grains.len(), contacts, rows, ends),
        }
    }

    /// Appends contacts of one kind by colours, as [`Sorter::append`] does, where nothing is known
    /// of them but their grains.
    pub(super) fn append_coloured(
        &mut self,
        (grains, contacts): (usize, &[Contact]),
        numbers: impl Iterator<Item = u32>,
        rows: &mut Vec<u32>,
        ends: &mut Vec<usize>,
    ) {
        self.begin(numbers, ends);
        self.colour(grains, contacts, rows, ends);
    }

    fn begin(&mut self, numbers: impl Iterator<Item = u32>, ends: &mut Vec<usize>) {
        self.detected.clear();
        self.detected.extend(numbers);
        ends.clear();
    }

    fn interleave(&self, rows: &mut Vec<u32>) {
        let stretch = self.detected.len().div_ceil(STREAMS);
        for offset in 0..stretch {
            rows.extend(self.detected[offset..].iter().step_by(stretch));
        }
    }

    /// By the potential of gravity at the contact points, which is the height times g where gravity
    /// is uniform.
    fn sort_by_height(&mut self, world: &World, contacts: &[Contact], rows: &mut Vec<u32>) {
        let potential = |&number: &u32| {
            let contact = &contacts[number as usize];
            let grain = contact.grain as usize;
            let (position, radius) = (world.grains.positions[grain], world.grains.radii[grain]);
            (world.gravity.potential(position - radius * contact.normal), number)
        };
        self.keys.clear();
        self.keys.extend(self.detected.iter().map(potential));
        self.keys.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        rows.extend(self.keys.iter().map(|&(_, number)| number));
    }

    /// Gives every contact the first colour that neither of its grains has yet: at most 2k − 1
    /// colours where no grain has more than k contacts.
    fn colour(
        &mut self,
        grains: usize,
        contacts: &[Contact],
        rows: &mut Vec<u32>,
        ends: &mut Vec<usize>,
    ) {
        self.taken.clear();
        self.taken.resize(grains, 0);
        self.colours.clear();
        let numbering = Numbering::of_grains(grains);
        let mut colour_of_its_own = COLOURS;
        for &number in &self.detected {
            let contact = &contacts[number as usize];
            let grains_of_contact =
                [Some(contact.grain as usize), numbering.other(contact.other).grain()];
            let moving = || grains_of_contact.into_iter().flatten();
            let taken = moving().fold(0, |taken, grain| taken | self.taken[grain]);
            let mut colour = taken.trailing_ones();
            if colour == COLOURS {
                colour = colour_of_its_own;
                colour_of_its_own += 1;
            } else {
                moving().for_each(|grain| self.taken[grain] |= 1 << colour);
            }
            self.colours.push((colour, number));
        }
        self.colours.sort_unstable();
        let before = rows.len();
        for colour in self.colours.chunk_by(|a, b| a.0 == b.0) {
            rows.extend(colour.iter().map(|&(_, number)| number));
            ends.push(rows.len() - before);
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::world::{Grain, Grains, Gravity};

    /// Discs whose height goes up and down with their number.
    fn world() -> World {
        let place = |k: u32| DVec2::new(f64::from(k), f64::from(k * 29 % 138));
        let grains: Vec<Grain> = (0..138).map(|k| Grain::at_rest(place(k), 0.4)).collect();
        World {
            grains: Grains::new(&grains, 1.0),
            fixed_discs: Vec::new(),
            boundaries: Vec::new(),
            gravity: Gravity::Uniform { acceleration: -9.8 * DVec2::Y },
            mean_diameter: 0.8,
        }
    }

    fn sorted(ordering: Ordering, contacts: &[Contact]) -> (Vec<u32>, Vec<usize>) {
        let world = world();
        let (mut rows, mut ends) = (Vec::new(), Vec::new());
        let numbers = 0..contacts.len() as u32;
        let mut sorter = Sorter::default();
        sorter.append(ordering, (&world, contacts), numbers, &mut rows, &mut ends);
        (rows, ends)
    }

    /// A hub with more neighbours than a grain keeps account of, and a ring around it.
    fn hub() -> Vec<Contact> {
        let contact = |grain, other| Contact { grain, other, normal: DVec2::Y, gap: -1e-9 };
        let spokes = (1..138).map(|other| contact(0, other));
        spokes.chain((1..137).map(|grain| contact(grain, grain + 1))).collect()
    }

    #[test]
    fn every_order_visits_every_contact_once() {
        let contacts = hub();
        for ordering in Ordering::ALL {
            let (mut rows, _) = sorted(*ordering, &contacts);
            rows.sort_unstable();
            assert!(rows.iter().copied().eq(0..contacts.len() as u32), "{ordering:?}");
        }
    }

    #[test]
    fn contacts_of_a_colour_share_no_grain() {
        let contacts = hub();
        let (rows, ends) = sorted(Ordering::Coloured, &contacts);
        assert_eq!(*ends.last().expect("colours"), rows.len());
        assert!(ends.len() >= 137, "a colour for each spoke");
        let mut start = 0;
        for &end in &ends {
            let mut grains: Vec<u32> = rows[start..end]
                .iter()
                .flat_map(|&row| [contacts[row as usize].grain, contacts[row as usize].other])
                .collect();
            let all = grains.len();
            grains.sort_unstable();
            grains.dedup();
            assert_eq!(grains.len(), all);
            start = end;
        }
    }

    #[test]
    fn bottom_up_rises() {
        let contacts = hub();
        let world = world();
        let (rows, _) = sorted(Ordering::BottomUp, &contacts);
        let heights: Vec<f64> = rows
            .iter()
            .map(|&row| {
                let grain = contacts[row as usize].grain as usize;
                world.grains.positions[grain].y - world.grains.radii[grain]
            })
            .collect();
        assert!(heights.is_sorted() && heights[0] < heights[rows.len() - 1]);
    }
}
