//! A cell list over a hashed uniform grid: points sorted by cell, in linear time and memory.
//!
//! Cells are square and as wide as the pairs looked for are apart at most, so that the two points
//! of a pair lie in one cell or in neighbouring ones. Each point looks at its own cell and at half
//! of the 8 around it (of the 2 on a line), so each pair is seen once. A cell's number is hashed into as many
//! buckets as there are points: a grain that flies off far away costs one bucket, not a larger
//! grid, and a scene far from the origin costs nothing. Points are sorted by bucket with a counting
//! sort; points of other cells in the same bucket are told apart by the stored cell.

use glam::DVec2;

/// The number of a cell along each axis.
type Cell = [i64; 2];

/// A cell list. All its memory is kept between rebuilds.
#[derive(Clone, Debug, Default)]
pub struct Grid {
    cells_per_metre: f64,
    /// Bucket b holds entries `starts[b] .. starts[b + 1]`; the number of buckets is a power of two.
    starts: Vec<u32>,
    /// Point indices, bucket by bucket, rising within a bucket.
    entries: Vec<u32>,
    /// The cell of each entry.
    cells: Vec<Cell>,
}

impl Grid {
    /// Sorts `positions` (m) into cells `cell_width` (m) wide.
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
        // Each bucket is filled from its end, so that its start is left in place: walking the
        // points backwards leaves them rising within the bucket.
        for (index, &position) in positions.iter().enumerate().rev() {
            let cell = self.cell::<AXES>(position);
            let bucket = self.bucket(cell);
            self.starts[bucket + 1] -= 1;
            let slot = self.starts[bucket + 1] as usize;
            self.entries[slot] = index as u32;
            self.cells[slot] = cell;
        }
        // Now entry b + 1 is the start of bucket b: move the list down by one.
        self.starts.copy_within(1.., 0);
        self.starts[buckets] = positions.len() as u32;
    }

    /// Calls `found` once with every pair of points in the same or in neighbouring cells: all pairs
    /// within one cell width are among them.
    pub fn pairs<const AXES: usize>(&self, mut found: impl FnMut(u32, u32)) {
        /// Neighbours in front, row by row; the first is the only one on a line.
        const FORWARD: [Cell; 4] = [[1, 0], [-1, 1], [0, 1], [1, 1]];
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

    fn cell<const AXES: usize>(&self, position: DVec2) -> Cell {
        let along = |coordinate: f64| (coordinate * self.cells_per_metre).floor() as i64;
        [along(position.x), if AXES == 1 { 0 } else { along(position.y) }]
    }

    fn bucket(&self, [x, y]: Cell) -> usize {
        // Odd multipliers with well-mixed high bits (the golden ratio's and a like one's) spread
        // neighbouring cells over the buckets; the high half is folded in because only low bits are kept.
        let mixed = (x as u64)
            .wrapping_mul(0x9e37_79b9_7f4a_7c15)
            .wrapping_add((y as u64).wrapping_mul(0xc2b2_ae3d_27d4_eb4f));
        (mixed ^ (mixed >> 32)) as usize & (self.starts.len() - 2)
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
