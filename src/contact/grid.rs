//! A cell list over a hashed uniform grid: points sorted by cell, in linear time and memory.
//!
//! Cells are square and as wide as the reach of a query, so that the points within reach of a
//! place lie in the 3 × 3 cells around it (3 × 1 on a line). A cell's number is hashed into as many
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

    /// Calls `found` with every point in the cells around `position`: all points within one cell
    /// width are among them, in an order that depends only on the points' cells and indices.
    pub fn around<const AXES: usize>(&self, position: DVec2, mut found: impl FnMut(u32)) {
        if self.entries.is_empty() {
            return;
        }
        let [x, y] = self.cell::<AXES>(position);
        let rows = if AXES == 1 { 0..=0 } else { -1..=1 };
        for row in rows {
            for column in -1..=1 {
                let cell = [x.wrapping_add(column), y.wrapping_add(row)];
                let bucket = self.bucket(cell);
                let range = self.starts[bucket] as usize..self.starts[bucket + 1] as usize;
                for slot in range {
                    if self.cells[slot] == cell {
                        found(self.entries[slot]);
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
    fn a_query_finds_all_points_within_one_cell_width_and_none_twice() {
        for origin in [DVec2::ZERO, DVec2::new(1e6, -3e5)] {
            let positions: Vec<DVec2> = (0..400)
                .map(|k| {
                    let k = k as f64;
                    origin + DVec2::new((k * 0.618).fract() * 9.0, (k * 0.414).fract() * 7.0)
                })
                .collect();
            let mut grid = Grid::default();
            grid.rebuild::<2>(&positions, 0.7);
            for &place in &positions {
                let mut found = Vec::new();
                grid.around::<2>(place, |index| found.push(index));
                let count = found.len();
                found.sort_unstable();
                found.dedup();
                assert_eq!(count, found.len(), "a point was found twice");
                for (index, &position) in positions.iter().enumerate() {
                    if position.distance(place) <= 0.7 {
                        assert!(found.contains(&(index as u32)));
                    }
                }
            }
        }
    }

    #[test]
    fn a_far_outlier_costs_no_memory() {
        let mut grid = Grid::default();
        grid.rebuild::<2>(&[DVec2::ZERO, DVec2::splat(1e12)], 1e-3);
        assert_eq!(grid.starts.len(), 3);
    }
}
