//! The order in which a sweep visits the contacts, and the groups of contacts that can be solved at the same time.
//!
//! In every order, contacts with fixed bodies come first, then contacts between grains, so that each of these two kinds
//! of contact has its own loop. The chosen order applies to each kind separately.

use std::ops::Range;

use glam::DVec2;

use crate::contact::{Contact, Numbering};
use crate::solver::method::Ordering;
use crate::world::World;

/// Groups of rows (each the data of one contact) that can be solved at the same time. All rows are contacts of one kind
/// (with fixed bodies, or between grains). They are sorted by tiles (square regions of the plane), and within a tile by
/// colours (groups of contacts that share no grain).
#[derive(Clone, Debug, Default)]
pub(crate) struct RowGroups {
    /// Ends of the colours, in the order of the tiles: the number of the row after the last row of each colour. A
    /// colour is a group of contacts of one tile that share no grain, and a tile is a square region of the plane. Rows
    /// are counted among the contacts of one kind (with fixed bodies, or between grains).
    pub colour_ends: Vec<usize>,
    /// Ends of the tiles in `colour_ends`: for each tile (square region of the plane), the index after its last colour
    /// (group of contacts that share no grain). Rows of two different tiles share no grain. The colours after the last
    /// tile contain the contacts between grains of different tiles.
    pub tile_ends: Vec<usize>,
}

impl RowGroups {
    /// Iterates over the colours (groups of contacts that share no grain) of tile number `tile`, a square region of the
    /// plane: returns the range of the rows of each colour. If `tile` is past the last tile, returns the colours of the
    /// contacts between grains of different tiles.
    pub(crate) fn colours_of(&self, tile: usize) -> impl Iterator<Item = Range<usize>> {
        let start_of = |ends: &[usize], at: usize| at.checked_sub(1).map_or(0, |at| ends[at]);
        let (ends, tiles) = (&self.colour_ends, &self.tile_ends);
        let all = tiles.len();
        let first = start_of(tiles, tile.min(all));
        let last = if tile < all { tiles[tile] } else { ends.len() };
        (first..last).map(move |colour| start_of(ends, colour)..ends[colour])
    }

    fn clear(&mut self) {
        self.colour_ends.clear();
        self.tile_ends.clear();
    }
}

/// Number of segments into which the list of detected contacts is cut for the interleaved order, which takes one
/// contact of each segment in turn. Neighbours in the list share a grain, so each update would wait until the update
/// before it has finished; interleaved updates change different grains. With fewer segments, updates wait for each
/// other; with many more, a sweep over a large pile uses the cache badly. If there are at most this many contacts of a
/// kind (with fixed bodies, or between grains), the interleaved order is the order of detection.
const STREAMS: usize = 8;

/// Number of colours (groups of contacts that share no grain) for which each grain stores a bit, in one integer of 128
/// bits. If a grain has so many neighbours that a contact finds no free colour, the contact gets a colour of its own.
const COLOURS: u32 = u128::BITS;

/// Sorts the contacts of a step into the order of the sweep. The memory is reused for the next step.
#[derive(Clone, Debug, Default)]
pub(crate) struct RowOrder {
    /// Groups of contacts that can be solved at the same time: first the groups of the contacts with fixed bodies, then
    /// the groups of the contacts between grains. Empty if the order of the sweep does not form such groups.
    pub groups: [RowGroups; 2],
    detected: Vec<u32>,
    keys: Vec<(f64, u32)>,
    tiles: Tiles,
    /// For each contact that has a colour (group of contacts of one tile that share no grain), two numbers: the number
    /// of its group and the number of the contact. The number of a group is tile · [`COLOURS`] + colour, with the
    /// number of the tile (square region of the plane) and the number of the colour.
    coloured: Vec<(u32, u32)>,
    /// Numbers of the contacts whose two grains are in different tiles (square regions of the plane).
    between: Vec<u32>,
    /// Numbers of the contacts for which no colour (group of contacts that share no grain) was free at both of their
    /// grains, because these grains have too many contacts. Each of these contacts forms a colour by itself.
    of_their_own: Vec<u32>,
    /// Two uses, one after the other: first the number of contacts in each colour (group of contacts that share no
    /// grain) of each tile (square region of the plane); then, while contacts are placed in the sorted list, the next
    /// free index of each colour.
    counts: Vec<usize>,
    /// For each grain, a bit set with the colours of its contacts so far. A colour is a group of contacts that share no
    /// grain, so a further contact of the grain must get another colour.
    taken: Vec<u128>,
}

impl RowOrder {
    /// Fills `rows` with the numbers of the contacts in the order `ordering` of the sweep. Returns the number of
    /// contacts with fixed bodies, which come first.
    pub(super) fn sort(
        &mut self,
        ordering: Ordering,
        world: &World,
        contacts: &[Contact],
        rows: &mut Vec<u32>,
    ) -> usize {
        rows.clear();
        if ordering == Ordering::Coloured {
            self.tiles.lay(world);
        }
        let grains = world.grains.len();
        let is_pair = |index: &u32| (contacts[*index as usize].other as usize) < grains;
        let mut fixed = 0;
        // First the contacts with fixed bodies, then the contacts between grains, each kind in the order of detection.
        for (kind, are_pairs) in [false, true].into_iter().enumerate() {
            fixed = rows.len();
            self.take((0..contacts.len() as u32).filter(|index| is_pair(index) == are_pairs), kind);
            match ordering {
                Ordering::Detected => rows.extend(&self.detected),
                Ordering::Interleaved | Ordering::Symmetric => self.interleave(rows),
                Ordering::BottomUp => self.sort_by_height(world, contacts, rows),
                Ordering::Coloured => self.colour(grains, contacts, rows, kind),
            }
        }
        fixed
    }

    /// Returns the contacts sorted by tiles (here sets of grains with consecutive numbers, because the positions of the
    /// grains are not known), and within a tile by colours (groups of contacts that share no grain). The first `fixed`
    /// contacts are with fixed bodies.
    pub(super) fn sort_by_colours(
        &mut self,
        grains: usize,
        contacts: &[Contact],
        fixed: usize,
    ) -> Vec<u32> {
        self.tiles.lay_by_number(grains);
        let mut rows = Vec::with_capacity(contacts.len());
        let (fixed, all) = (fixed as u32, contacts.len() as u32);
        for (kind, numbers) in [0..fixed, fixed..all].into_iter().enumerate() {
            self.take(numbers, kind);
            self.colour(grains, contacts, &mut rows, kind);
        }
        rows
    }

    /// Stores the numbers of the contacts that are to be sorted next, and removes the previous groups of the same kind
    /// of contact. All these contacts are of the kind `kind`: 0 for contacts with fixed bodies, 1 for contacts between
    /// grains.
    fn take(&mut self, numbers: impl Iterator<Item = u32>, kind: usize) {
        self.detected.clear();
        self.detected.extend(numbers);
        self.groups[kind].clear();
    }

    fn interleave(&self, rows: &mut Vec<u32>) {
        let stretch = self.detected.len().div_ceil(STREAMS);
        for offset in 0..stretch {
            rows.extend(self.detected[offset..].iter().step_by(stretch));
        }
    }

    /// Sorts contacts by increasing potential of gravity (J/kg) at the contact points. If gravity is uniform, the
    /// potential is g times the height, so the lowest contact comes first.
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

    /// Sorts contacts by the tiles (square regions of the plane) of their grains, and within a tile by colours (groups
    /// of contacts that share no grain). Contacts between grains of different tiles come last. Each contact gets the
    /// first colour that is not yet used at either of its grains. If no grain has more than k contacts, there are at
    /// most 2k − 1 colours.
    fn colour(&mut self, grains: usize, contacts: &[Contact], rows: &mut Vec<u32>, kind: usize) {
        self.coloured.clear();
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
        // Contacts between tiles are solved after all others, so their colours start again from the first.
        self.taken.fill(0);
        for at in 0..self.between.len() {
            let number = self.between[at];
            self.take_colour(self.tiles.count, number, grains_of(number));
        }
        self.group(rows, kind);
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
        self.coloured.push((tile as u32 * COLOURS + colour, number));
    }

    /// Counts the contacts of each colour (group of contacts that share no grain) of each tile (square region of the
    /// plane), and appends their numbers to `rows` tile by tile and colour by colour, within a colour in the order of
    /// detection.
    fn group(&mut self, rows: &mut Vec<u32>, kind: usize) {
        let tiles = self.tiles.count;
        let (counts, groups) = (&mut self.counts, &mut self.groups[kind]);
        counts.clear();
        counts.resize((tiles + 1) * COLOURS as usize, 0);
        for &(group, _) in &self.coloured {
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
        for &(group, number) in &self.coloured {
            let place = &mut counts[group as usize];
            rows[before + *place] = number;
            *place += 1;
        }
        // Contacts without a free colour belong to no tile.
        for &number in &self.of_their_own {
            rows.push(number);
            groups.colour_ends.push(rows.len() - before);
        }
        groups.tile_ends.pop();
    }
}

/// Number of grains per tile (square region whose contacts one thread solves) in a dense pile: the velocities of 512
/// grains take 16 KB, a third of the first-level cache of a current processor. With fewer grains, more contacts are
/// between grains of different tiles, and a single thread has to solve these contacts after all tiles. With more
/// grains, the data of the contacts push velocities out of the cache, and a small pile has too few tiles for several
/// threads.
const GRAINS_IN_TILE: usize = 512;
/// Maximum number of grains of a scene that is not divided into tiles (regions whose contacts one thread solves): the
/// data of the contacts of this number of grains fit in the second-level cache, and waking a second thread would cost
/// more than it gains.
const GRAINS_IN_ONE: usize = 2048;
/// Minimum number of grains per tile (square region whose contacts one thread solves), on average, in a scene with
/// large gaps between grains: an eighth of the number in a dense pile. With a smaller number, more tiles may be empty;
/// with a larger number, tiles are larger, and a tile in a dense region contains more grains, whose velocities may not
/// fit in the cache.
const LEAST_GRAINS_A_TILE: usize = 64;

/// The tile of each grain. Tiles are squares of the plane, so small that the velocities of one tile's grains stay in
/// the first-level cache while its contacts are solved. Two tiles share no grain, so several tiles can be solved at the
/// same time.
#[derive(Clone, Debug, Default)]
struct Tiles {
    of_grain: Vec<u32>,
    /// Number of tiles, the square regions into which the plane is divided.
    count: usize,
}

impl Tiles {
    /// Divides the grains of a world into square tiles (regions whose contacts one thread solves) of equal size. The
    /// tiles depend only on the relative positions of the grains.
    fn lay(&mut self, world: &World) {
        let positions = &world.grains.positions;
        if positions.len() <= GRAINS_IN_ONE {
            return self.lay_one(positions.len());
        }
        let corner = |pick: fn(DVec2, DVec2) -> DVec2| positions.iter().copied().reduce(pick);
        let (Some(low), Some(high)) = (corner(DVec2::min), corner(DVec2::max)) else {
            return self.lay_one(0);
        };
        let extent = high - low;
        let most = (positions.len() / LEAST_GRAINS_A_TILE) as f64;
        let squares = |side: f64| (extent / side).floor() + DVec2::ONE;
        let mut side = world.mean_diameter * (GRAINS_IN_TILE as f64).sqrt();
        while squares(side).element_product() > most {
            side *= 2.0;
        }
        // If grains are infinitely far apart, the number of squares is NaN, and `max` makes it 1.
        let [columns, rows] = squares(side).to_array().map(|count| count.max(1.0) as usize);
        self.count = columns * rows;
        self.of_grain.clear();
        self.of_grain.extend(positions.iter().map(|&position| {
            let [column, row] = ((position - low) / side).to_array().map(|place| place as usize);
            (row.min(rows - 1) * columns + column.min(columns - 1)) as u32
        }));
    }

    /// Divides grains into tiles (sets of grains whose contacts one thread solves) if their positions are not known:
    /// grains with consecutive numbers form a tile.
    fn lay_by_number(&mut self, grains: usize) {
        if grains <= GRAINS_IN_ONE {
            return self.lay_one(grains);
        }
        self.count = grains.div_ceil(GRAINS_IN_TILE);
        self.of_grain.clear();
        self.of_grain.extend((0..grains).map(|grain| (grain / GRAINS_IN_TILE) as u32));
    }

    fn lay_one(&mut self, grains: usize) {
        self.count = 1;
        self.of_grain.clear();
        self.of_grain.resize(grains, 0);
    }

    /// Returns the number of the tile (square region of the plane) that contains both grains; `None` if they are in
    /// different tiles. An entry of `grains` that is `None` is ignored.
    fn of(&self, grains: [Option<usize>; 2]) -> Option<usize> {
        let mut tiles = grains.into_iter().flatten().map(|grain| self.of_grain[grain] as usize);
        let first = tiles.next()?;
        tiles.all(|tile| tile == first).then_some(first)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::{Grain, Grains, Gravity};

    const SIDE: usize = 60;

    fn world(grains: impl Iterator<Item = Grain>) -> World {
        let grains: Vec<Grain> = grains.collect();
        let gravity = Gravity::Uniform { acceleration: -9.8 * DVec2::Y };
        World::of(Grains::new(&grains, 1.0), gravity, 2.0 * grains[0].radius)
    }

    /// Returns a world of discs whose heights change irregularly from each disc to the next, in the order of their
    /// numbers.
    fn uneven() -> World {
        world(
            (0..138)
                .map(|k| Grain::at_rest(DVec2::new(f64::from(k), f64::from(k * 29 % 138)), 0.4)),
        )
    }

    fn sorted(ordering: Ordering, contacts: &[Contact]) -> (Vec<u32>, Vec<usize>) {
        let world = uneven();
        let (mut rows, mut order) = (Vec::new(), RowOrder::default());
        order.sort(ordering, &world, contacts, &mut rows);
        let [_, pairs] = order.groups;
        (rows, pairs.colour_ends)
    }

    /// Returns the contacts of a disc with more neighbours than there are colours, and contacts between these
    /// neighbours.
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
        let world = uneven();
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

    /// Returns a world of discs whose positions are the points of a square lattice, transformed by `place`.
    fn lattice(place: impl Fn(DVec2) -> DVec2) -> World {
        let lattice = (0..SIDE * SIDE).map(|k| DVec2::new((k % SIDE) as f64, (k / SIDE) as f64));
        world(lattice.map(|at| Grain::at_rest(place(at), 0.5)))
    }

    fn laid(place: impl Fn(DVec2) -> DVec2) -> Tiles {
        let mut tiles = Tiles::default();
        tiles.lay(&lattice(place));
        assert_eq!(tiles.of_grain.len(), SIDE * SIDE);
        assert!(tiles.of_grain.iter().all(|&tile| (tile as usize) < tiles.count));
        tiles
    }

    #[test]
    fn tiles_of_a_dense_packing_are_squares_wherever_it_lies() {
        let tiles = laid(|at| at);
        // The outermost grains are 59 diameters apart, and a tile has a side of 22.6 diameters: three tiles along each
        // side.
        assert_eq!(tiles.count, 9);
        for tile in 0..9 {
            let (mut low, mut high) = (DVec2::MAX, DVec2::MIN);
            let numbers = (0..SIDE * SIDE).filter(|&k| tiles.of_grain[k] == tile);
            for k in numbers {
                let at = DVec2::new((k % SIDE) as f64, (k / SIDE) as f64);
                (low, high) = (low.min(at), high.max(at));
            }
            assert!((high - low).max_element() <= (GRAINS_IN_TILE as f64).sqrt(), "{low} {high}");
        }
        assert_eq!(tiles.of([Some(0), Some(1)]), Some(0));
        assert_eq!(tiles.of([Some(0), None]), Some(0));
        assert_eq!(tiles.of([Some(22), Some(23)]), None);
        let moved = laid(|at| at + DVec2::new(1e6, -1e6));
        assert_eq!(moved.of_grain, tiles.of_grain);
    }

    #[test]
    fn few_grains_are_one_tile_and_far_ones_do_not_make_many() {
        for far in [1e3, 1e12, 1e300] {
            let tiles = laid(|at| at * far);
            assert!(tiles.count <= SIDE * SIDE / LEAST_GRAINS_A_TILE, "{}", tiles.count);
        }
        // The grains are so far apart that their distance overflows.
        assert_eq!(laid(|at| (at - DVec2::splat(0.5)).signum() * f64::MAX).count, 1);
        let mut tiles = Tiles::default();
        tiles.lay_by_number(GRAINS_IN_ONE);
        assert_eq!(tiles.count, 1);
        tiles.lay_by_number(GRAINS_IN_ONE + 1);
        assert_eq!(tiles.count, 5);
    }
}
