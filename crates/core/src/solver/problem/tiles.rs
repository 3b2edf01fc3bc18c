//! Tiles: squares of the plane, so small that the bodies of one stay in the nearest cache while its contacts
//! are solved, and that share no grain, so that several can be solved at the same time.

use glam::DVec2;

use crate::world::World;

/// Grains of a dense pile in a tile: bodies of 16 KB, a third of the nearest cache of a processor of today. With
/// fewer, more contacts lie between tiles; with more, bodies are pushed out of the cache by rows that pass
/// through, and a small pile has too few tiles for several threads.
const GRAINS_IN_TILE: usize = 512;
/// Scenes of up to so many grains are one tile: their rows fit in the second cache, and waking a thread costs
/// more than it gains.
pub(super) const GRAINS_IN_ONE: usize = 2048;
/// Tiles of a scene that is not dense: no more than one for so many grains, that empty ones cost nothing.
const LEAST_GRAINS_A_TILE: usize = 64;

/// Which tile each grain lies in.
#[derive(Clone, Debug, Default)]
pub(super) struct Tiles {
    of_grain: Vec<u32>,
    /// How many there are.
    count: usize,
}

impl Tiles {
    /// Lays squares over the grains of a world. They depend on where the grains lie to each other alone.
    pub(super) fn lay(&mut self, world: &World) {
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
        // Grains that are infinitely far from each other leave a number that is none.
        let [columns, rows] = squares(side).to_array().map(|count| count.max(1.0) as usize);
        self.count = columns * rows;
        self.of_grain.clear();
        self.of_grain.extend(positions.iter().map(|&position| {
            let [column, row] = ((position - low) / side).to_array().map(|place| place as usize);
            (row.min(rows - 1) * columns + column.min(columns - 1)) as u32
        }));
    }

    /// One tile after the other takes its share of the grains as they are numbered, where nothing is known of
    /// their places.
    pub(super) fn lay_by_number(&mut self, grains: usize) {
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

    /// How many there are.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// The tile that all of these grains lie in; none where they lie in several.
    pub(super) fn of(&self, grains: [Option<usize>; 2]) -> Option<usize> {
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

    /// Discs on a square lattice, moved and stretched.
    fn world(place: impl Fn(DVec2) -> DVec2) -> World {
        let lattice = (0..SIDE * SIDE).map(|k| DVec2::new((k % SIDE) as f64, (k / SIDE) as f64));
        let grains: Vec<_> = lattice.map(|at| Grain::at_rest(place(at), 0.5)).collect();
        World {
            grains: Grains::new(&grains, 1.0),
            fixed_discs: Vec::new(),
            boundaries: Vec::new(),
            motions: Vec::new(),
            gravity_turn: None,
            periodic: None,
            gravity: Gravity::Uniform { acceleration: -9.8 * DVec2::Y },
            mean_diameter: 1.0,
        }
    }

    fn laid(place: impl Fn(DVec2) -> DVec2) -> Tiles {
        let mut tiles = Tiles::default();
        tiles.lay(&world(place));
        assert_eq!(tiles.of_grain.len(), SIDE * SIDE);
        assert!(tiles.of_grain.iter().all(|&tile| (tile as usize) < tiles.count()));
        tiles
    }

    #[test]
    fn tiles_of_a_dense_packing_are_squares_wherever_it_lies() {
        let tiles = laid(|at| at);
        // 59 diameters between the outermost, by 22.6.
        assert_eq!(tiles.count(), 9);
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
            assert!(tiles.count() <= SIDE * SIDE / LEAST_GRAINS_A_TILE, "{}", tiles.count());
        }
        // So far apart that the distance is no number.
        assert_eq!(laid(|at| (at - DVec2::splat(0.5)).signum() * f64::MAX).count(), 1);
        let mut tiles = Tiles::default();
        tiles.lay_by_number(GRAINS_IN_ONE);
        assert_eq!(tiles.count(), 1);
        tiles.lay_by_number(GRAINS_IN_ONE + 1);
        assert_eq!(tiles.count(), 5);
    }
}
