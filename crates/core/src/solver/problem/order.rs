//! In which order a sweep visits the contacts.
//!
//! Whatever the order, contacts with fixed bodies come first, then those between grains, so that
//! each kind has a loop of its own; an order is one within each kind.

use super::groups::Groups;
use super::tiles::Tiles;
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
    tiles: Tiles,
    /// Contacts with their tile and colour, as one number.
    groups: Vec<(u32, u32)>,
    /// Contacts between tiles.
    between: Vec<u32>,
    /// Contacts that found no colour.
    of_their_own: Vec<u32>,
    /// Contacts of each colour of each tile, then where the next of them goes.
    counts: Vec<usize>,
    /// The colours that each grain has, one bit each.
    taken: Vec<u128>,
}

impl Sorter {
    /// Appends the contacts `numbers` of one kind, given in the order of detection, to `rows`. Where
    /// they are coloured, `groups` gets which of what was appended belong together; tiles are those of
    /// [`Sorter::begin`].
    pub(super) fn append(
        &mut self,
        ordering: Ordering,
        (world, contacts): (&World, &[Contact]),
        numbers: impl Iterator<Item = u32>,
        rows: &mut Vec<u32>,
        groups: &mut Groups,
    ) {
        self.take(numbers, groups);
        match ordering {
            Ordering::Detected => rows.extend(&self.detected),
            Ordering::Interleaved | Ordering::Symmetric => self.interleave(rows),
            Ordering::BottomUp => self.sort_by_height(world, contacts, rows),
            Ordering::Coloured => self.colour(world.grains.len(), contacts, rows, groups),
        }
    }

    /// Appends contacts of one kind by colours, as [`Sorter::append`] does, where nothing is known
    /// of them but their grains.
    pub(super) fn append_coloured(
        &mut self,
        (grains, contacts): (usize, &[Contact]),
        numbers: impl Iterator<Item = u32>,
        rows: &mut Vec<u32>,
        groups: &mut Groups,
    ) {
        self.tiles.lay_by_number(grains);
        self.take(numbers, groups);
        self.colour(grains, contacts, rows, groups);
    }

    /// Lays the tiles of a step, where its order needs them.
    pub(super) fn begin(&mut self, ordering: Ordering, world: &World) {
        if ordering == Ordering::Coloured {
            self.tiles.lay(world);
        }
    }

    fn take(&mut self, numbers: impl Iterator<Item = u32>, groups: &mut Groups) {
        self.detected.clear();
        self.detected.extend(numbers);
        groups.clear();
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

    /// Sorts contacts by tiles, those between tiles last, and within a tile by colours: every contact gets
    /// the first colour that neither of its grains has yet, which makes at most 2k − 1 colours where no
    /// grain has more than k contacts.
    fn colour(
        &mut self,
        grains: usize,
        contacts: &[Contact],
        rows: &mut Vec<u32>,
        groups: &mut Groups,
    ) {
        self.groups.clear();
        self.of_their_own.clear();
        self.between.clear();
        self.taken.clear();
        self.taken.resize(grains, 0);
        let numbering = Numbering::of_grains(grains);
        let grains_of = |number: u32| {
            let contact = &contacts[number as usize];
            [Some(contact.grain as usize), numbering.other(contact.other).grain()]
        };
        for at in 0..self.detected.len() {
            let number = self.detected[at];
            match self.tiles.of(grains_of(number)) {
                Some(tile) => self.take_colour(tile, number, grains_of(number)),
                None => self.between.push(number),
            }
        }
        // Between tiles colours are counted anew: they are solved after all others.
        self.taken.fill(0);
        for at in 0..self.between.len() {
            let number = self.between[at];
            self.take_colour(self.tiles.count(), number, grains_of(number));
        }
        self.group(rows, groups);
    }

    fn take_colour(&mut self, tile: usize, number: u32, grains: [Option<usize>; 2]) {
        let moving = || grains.into_iter().flatten();
        let taken = moving().fold(0, |taken, grain| taken | self.taken[grain]);
        let colour = taken.trailing_ones();
        if colour == COLOURS {
            self.of_their_own.push(number);
            return;
        }
        moving().for_each(|grain| self.taken[grain] |= 1 << colour);
        self.groups.push((tile as u32 * COLOURS + colour, number));
    }

    /// Counts how many contacts each colour of each tile has, and puts them there in the order of detection.
    fn group(&mut self, rows: &mut Vec<u32>, groups: &mut Groups) {
        let tiles = self.tiles.count();
        let counts = &mut self.counts;
        counts.clear();
        counts.resize((tiles + 1) * COLOURS as usize, 0);
        for &(group, _) in &self.groups {
            counts[group as usize] += 1;
        }
        let before = rows.len();
        let mut end = 0;
        for of_tile in counts.chunks_exact_mut(COLOURS as usize) {
            for count in of_tile.iter_mut().filter(|count| **count > 0) {
                let start = end;
                end += std::mem::replace(count, start);
                groups.colour_ends.push(end);
            }
            groups.tile_ends.push(groups.colour_ends.len());
        }
        rows.resize(before + end, 0);
        for &(group, number) in &self.groups {
            let place = &mut counts[group as usize];
            rows[before + *place] = number;
            *place += 1;
        }
        // Whoever has more neighbours than there are colours lies in no tile.
        for &number in &self.of_their_own {
            rows.push(number);
            groups.colour_ends.push(rows.len() - before);
        }
        groups.tile_ends.pop();
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
            motions: Vec::new(),
            gravity_turn: None,
            periodic: None,
            gravity: Gravity::Uniform { acceleration: -9.8 * DVec2::Y },
            mean_diameter: 0.8,
        }
    }

    fn sorted(ordering: Ordering, contacts: &[Contact]) -> (Vec<u32>, Vec<usize>) {
        let world = world();
        let (mut rows, mut groups) = (Vec::new(), Groups::default());
        let numbers = 0..contacts.len() as u32;
        let mut sorter = Sorter::default();
        sorter.begin(ordering, &world);
        sorter.append(ordering, (&world, contacts), numbers, &mut rows, &mut groups);
        (rows, groups.colour_ends)
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
