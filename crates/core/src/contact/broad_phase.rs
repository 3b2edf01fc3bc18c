//! Search for nearby discs, with a grid if the discs have similar sizes and with a tree otherwise.
//!
//! **The grid** is a cell list over a hashed uniform grid: points sorted by cell, in linear time and memory. The cells
//! are squares. Their width is the largest distance between the centres of two discs at which a pair is searched: the
//! diameter of the largest disc plus two search margins (lengths that are added to the radii, so that pairs that may
//! touch soon are found, too). So the two points of a pair lie in the same cell or in neighbouring cells. Each point
//! (the centre of a disc) is compared with the points of its own cell and with those of 4 of the 8 cells around it, so
//! each pair is found once. In scenes on a line, a cell has 2 neighbours, and one of them is searched. The index of a
//! cell is hashed into about as many buckets as there are points. So a grain that flies far away costs one bucket
//! instead of a larger grid, and a scene far from the origin costs nothing. Points are sorted by bucket with a counting
//! sort. The stored cell of each point distinguishes points of different cells in the same bucket.
//!
//! **The tree** is the bounding volume hierarchy of the Rust library `parry`, for discs of very different sizes. Grid
//! cells are wider than the largest disc, so each small disc would be compared with very many others. A tree does not
//! need a common cell width. The tree is built once. After that, its bounding boxes are adjusted to the moved discs,
//! and its structure is improved a little in each search. According to `cargo bench --bench broad_phase`, building the
//! tree again for each search is slower than the grid.

use glam::DVec2;
use parry2d_f64::bounding_volume::Aabb;
use parry2d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};

/// Ratio of the largest to the smallest disc above which the search uses the tree. Below it, the search uses the grid.
/// The sizes that are compared are the radii of the discs, and also the radii plus search margins (lengths added to the
/// radii, so that pairs that may touch soon are found, too). The value lies between two measured ratios: at 1.5 the
/// grid and the tree take about the same time, and at 20 the grid takes 1.2 to 18 times as long as the tree (`cargo
/// bench --bench broad_phase`).
const SIZE_RATIO_OF_TREE: f64 = 4.0;

/// Search for pairs of nearby discs, by a grid or a tree.
#[derive(Clone, Debug, Default)]
pub struct BroadPhase {
    radii_differ: bool,
    finder: PairFinder,
}

#[derive(Clone, Debug)]
enum PairFinder {
    Grid(Grid),
    Tree(Box<Tree>),
}

impl Default for PairFinder {
    fn default() -> Self {
        Self::Grid(Grid::default())
    }
}

impl BroadPhase {
    /// Creates an object that searches for pairs of nearby discs. `radii` are the radii of the discs, m. They decide if
    /// the search uses a grid or a tree.
    pub fn of(radii: &[f64]) -> Self {
        let (radii_differ, _) = spread(radii.iter().copied());
        Self { radii_differ, ..Self::default() }
    }

    /// Discards the tree (bounding volume hierarchy) of the discs, if the search uses a tree, because the next search
    /// has a different number of discs.
    pub(crate) fn forget_discs(&mut self) {
        if matches!(self.finder, PairFinder::Tree(_)) {
            self.finder = PairFinder::default();
        }
    }

    /// Calls `found` once for every pair of discs whose centres are closer than the sum of their extents (radius plus
    /// search margin, m). It is also called for some pairs that are farther apart.
    pub fn pairs<const AXES: usize>(
        &mut self,
        centres: &[DVec2],
        extents: impl Iterator<Item = f64> + Clone,
        found: impl FnMut(u32, u32),
    ) {
        let (extents_differ, largest) = spread(extents.clone());
        let by_tree = self.radii_differ || extents_differ;
        if by_tree != matches!(self.finder, PairFinder::Tree(_)) {
            self.finder =
                if by_tree { PairFinder::Tree(Box::default()) } else { PairFinder::default() };
        }
        match &mut self.finder {
            PairFinder::Grid(grid) => {
                grid.rebuild::<AXES>(centres, 2.0 * largest);
                grid.pairs::<AXES>(found);
            }
            PairFinder::Tree(tree) => {
                let on_axes = |&centre: &DVec2| match AXES {
                    1 => DVec2::new(centre.x, 0.0),
                    _ => centre,
                };
                tree.update(centres.iter().map(on_axes).zip(extents));
                tree.pairs(found);
            }
        }
    }
}

/// Returns true if the sizes of the discs (radii, or radii plus the lengths that the search adds to the radii, m)
/// differ so much that the search uses the tree. Also returns the largest size, m.
fn spread(sizes: impl Iterator<Item = f64> + Clone) -> (bool, f64) {
    let largest = sizes.clone().fold(0.0, f64::max);
    let smallest = sizes.fold(f64::INFINITY, f64::min);
    (largest > SIZE_RATIO_OF_TREE * smallest, largest)
}

/// The index of a grid cell along each axis.
type GridCell = [i64; 2];

/// A cell list (hashed uniform grid) of points. Its allocated memory is kept between rebuilds.
#[derive(Clone, Debug, Default)]
pub struct Grid {
    cells_per_metre: f64,
    /// For each bucket (the points whose grid cells have the same hash), the index in `entries` at which its points
    /// start: the points of bucket b are `entries[starts[b] .. starts[b + 1]]`. The number of buckets is a power of
    /// two.
    starts: Vec<u32>,
    /// Indices of all points, sorted by bucket (points whose grid cells have the same hash). Within a bucket the
    /// indices increase.
    entries: Vec<u32>,
    /// For each entry of `entries` (the index of a point), the grid cell of the point.
    cells: Vec<GridCell>,
}

impl Grid {
    /// Sorts the points at `positions` (m) into square cells of width `cell_width` (m).
    pub fn rebuild<const AXES: usize>(&mut self, positions: &[DVec2], cell_width: f64) {
        self.cells_per_metre = 1.0 / cell_width;
        let buckets = positions.len().next_power_of_two();
        self.starts.clear();
        self.starts.resize(buckets + 1, 0);
        for &position in positions {
            let bucket = self.bucket(self.cell::<AXES>(position));
            self.starts[bucket + 1] += 1;
        }
        for bucket in 0..buckets {
            self.starts[bucket + 1] += self.starts[bucket];
        }
        self.entries.resize(positions.len(), 0);
        self.cells.resize(positions.len(), [0; 2]);
        // Fill each bucket from its end down to its start. Going through the points backwards leaves them in
        // increasing order within the bucket.
        for (index, &position) in positions.iter().enumerate().rev() {
            let cell = self.cell::<AXES>(position);
            let bucket = self.bucket(cell);
            self.starts[bucket + 1] -= 1;
            let slot = self.starts[bucket + 1] as usize;
            self.entries[slot] = index as u32;
            self.cells[slot] = cell;
        }
        // Element b + 1 of `starts` is now the start of bucket b, so move the list down by one element.
        self.starts.copy_within(1.., 0);
        self.starts[buckets] = positions.len() as u32;
    }

    /// Calls `found` once for every pair of points that are in the same cell or in neighbouring cells. These include
    /// all pairs of points that are at most one cell width apart.
    pub fn pairs<const AXES: usize>(&self, mut found: impl FnMut(u32, u32)) {
        /// Offsets from a grid cell to half of its 8 neighbouring cells. The other half is not needed, because a search
        /// from those cells finds the same pairs. On a line a cell has 2 neighbours, and only the first offset is used.
        const FORWARD: [GridCell; 4] = [[1, 0], [-1, 1], [0, 1], [1, 1]];
        let forward = if AXES == 1 { &FORWARD[..1] } else { &FORWARD };
        for (slot, (&point, &cell)) in self.entries.iter().zip(&self.cells).enumerate() {
            let own_bucket_end = self.starts[self.bucket(cell) + 1] as usize;
            for other in slot + 1..own_bucket_end {
                if self.cells[other] == cell {
                    found(point, self.entries[other]);
                }
            }
            for step in forward {
                let neighbour = [cell[0].wrapping_add(step[0]), cell[1].wrapping_add(step[1])];
                let bucket = self.bucket(neighbour);
                for other in self.starts[bucket] as usize..self.starts[bucket + 1] as usize {
                    if self.cells[other] == neighbour {
                        found(point, self.entries[other]);
                    }
                }
            }
        }
    }

    fn cell<const AXES: usize>(&self, position: DVec2) -> GridCell {
        let along = |coordinate: f64| (coordinate * self.cells_per_metre).floor() as i64;
        [along(position.x), if AXES == 1 { 0 } else { along(position.y) }]
    }

    fn bucket(&self, [x, y]: GridCell) -> usize {
        // Multiplication by odd numbers with well-mixed high bits (the first is derived from the golden ratio)
        // spreads neighbouring cells over the buckets. The high half of the product is combined with the low half,
        // because only low bits are used.
        let mixed = (x as u64)
            .wrapping_mul(0x9e37_79b9_7f4a_7c15)
            .wrapping_add((y as u64).wrapping_mul(0xc2b2_ae3d_27d4_eb4f));
        (mixed ^ (mixed >> 32)) as usize & (self.starts.len() - 2)
    }
}

/// A bounding volume hierarchy of discs. The pairs that it finds depend only on the discs, not on earlier searches.
#[derive(Clone, Default)]
struct Tree {
    tree: Bvh,
    workspace: BvhWorkspace,
}

impl std::fmt::Debug for Tree {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("Tree").finish_non_exhaustive()
    }
}

impl Tree {
    /// Fits the tree of bounding squares to discs (centre and radius, m). The first call builds the tree. The number of
    /// discs must not change between calls.
    fn update(&mut self, discs: impl Iterator<Item = (DVec2, f64)>) {
        let boxes = discs
            .map(|(centre, radius)| Aabb::from_half_extents(centre, DVec2::splat(radius)))
            .enumerate();
        if self.tree.is_empty() {
            self.tree = Bvh::from_iter(BvhBuildStrategy::Binned, boxes);
            return;
        }
        for (index, reach) in boxes {
            self.tree.insert_or_update_partially(reach, index as u32, 0.0);
        }
        self.tree.refit_without_opt();
        self.tree.optimize_incremental(&mut self.workspace);
    }

    /// Calls `found` once for every pair of discs whose bounding squares overlap.
    fn pairs(&mut self, mut found: impl FnMut(u32, u32)) {
        self.tree.traverse_bvtt_single_tree::<false>(&mut self.workspace, &mut found);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_pairs_within_one_cell_width_are_found_and_none_twice() {
        for origin in [DVec2::ZERO, DVec2::new(1e6, -3e5)] {
            let positions: Vec<DVec2> = (0..400)
                .map(|k| {
                    let k = k as f64;
                    origin + DVec2::new((k * 0.618).fract() * 9.0, (k * 0.414).fract() * 7.0)
                })
                .collect();
            let mut grid = Grid::default();
            grid.rebuild::<2>(&positions, 0.7);
            let mut found = std::collections::HashSet::new();
            grid.pairs::<2>(|i, j| {
                assert!(found.insert((i.min(j), i.max(j))), "{i} and {j} were found twice");
            });
            let mut close = 0;
            for i in 0..positions.len() {
                for j in i + 1..positions.len() {
                    if positions[i].distance(positions[j]) <= 0.7 {
                        close += 1;
                        assert!(found.contains(&(i as u32, j as u32)));
                    }
                }
            }
            assert!(close > 400, "{close} pairs are close");
        }
    }

    #[test]
    fn a_far_outlier_costs_no_memory() {
        let mut grid = Grid::default();
        grid.rebuild::<2>(&[DVec2::ZERO, DVec2::splat(1e12)], 1e-3);
        assert_eq!(grid.starts.len(), 3);
    }
}
