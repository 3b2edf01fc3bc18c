//! The discs that are in place, by columns, so that what a falling disc meets is found in constant
//! time.

use glam::DVec2;

use crate::world::Disc;

/// Part of the reach that is rounding: by so much a disc may overlap one that it passes, or lie above where
/// its fall began. None, and a disc between two that leave it just the room is handed from one to the other
/// without end, and one that falls off where it touches the next falls through that; with it, each
/// fall still ends lower, by a millionth of the reach at least.
pub(super) const GRAZING: f64 = 1e-12;

/// What a disc can be dropped on: fixed discs, those that were dropped before, a floor, two walls.
#[derive(Clone, Debug)]
pub struct Surface {
    discs: Vec<Disc>,
    /// The discs whose centres lie in each column, by height.
    columns: Vec<Vec<u32>>,
    column_width: f64,
    largest_radius: f64,
    floor: f64,
    half_width: f64,
}

impl Surface {
    /// A box with a floor at height `floor` and walls at ± `half_width`, m, for discs of at most
    /// `largest_radius`, m. All are finite, and `half_width` is at least `largest_radius`, above 0.
    pub fn new(floor: f64, half_width: f64, largest_radius: f64) -> Self {
        let column_width = 2.0 * largest_radius;
        let count = (2.0 * half_width / column_width).ceil() as usize + 2;
        Self {
            discs: Vec::new(),
            columns: vec![Vec::new(); count],
            column_width,
            largest_radius,
            floor,
            half_width,
        }
    }

    /// Puts a disc in place. Those farther outside of the walls than a column's width are met by none.
    pub fn add(&mut self, disc: Disc) {
        let index = self.discs.len() as u32;
        let column = self.column(disc.position.x);
        self.discs.push(disc);
        let (discs, column) = (&self.discs, &mut self.columns[column]);
        let is_lower = |&other: &u32| discs[other as usize].position.y <= disc.position.y;
        let above = column.iter().rev().take_while(|other| !is_lower(other)).count();
        column.insert(column.len() - above, index);
    }

    /// All that are in place, as they came.
    pub fn discs(&self) -> &[Disc] {
        &self.discs
    }

    /// Height of the floor, m.
    pub(super) fn floor(&self) -> f64 {
        self.floor
    }

    /// The walls are at ± this, m.
    pub(super) fn half_width(&self) -> f64 {
        self.half_width
    }

    /// The highest place at x, not above `highest`, where a disc that falls comes to lie on one of those in place but for
    /// `left`, the one that it falls from; and that one's index. Nothing where it falls to the floor.
    pub(super) fn landing(
        &self,
        x: f64,
        radius: f64,
        highest: f64,
        left: Option<usize>,
    ) -> Option<(f64, usize)> {
        let mut best = None;
        let mut best_height = self.floor + radius;
        for column in self.columns_within(x, radius + self.largest_radius) {
            for &index in column.iter().rev() {
                let Disc { position, radius: other } = self.discs[index as usize];
                let reach = radius + other;
                if position.y + radius + self.largest_radius <= best_height {
                    break;
                }
                let aside = x - position.x;
                if aside.abs() > (1.0 - GRAZING) * reach || left == Some(index as usize) {
                    continue;
                }
                let height = position.y + ((reach - aside) * (reach + aside)).sqrt();
                if height > best_height && height <= highest + GRAZING * reach {
                    (best, best_height) = (Some((height, index as usize)), height);
                }
            }
        }
        best
    }

    /// Calls `visit` with the index of each disc that one of that radius may touch whose centre is within
    /// the rectangle; of others as well.
    pub(super) fn each_near(
        &self,
        [min, max]: [DVec2; 2],
        radius: f64,
        mut visit: impl FnMut(usize, &Disc),
    ) {
        let reach = radius + self.largest_radius;
        let middle = 0.5 * (min.x + max.x);
        for column in self.columns_within(middle, 0.5 * (max.x - min.x) + reach) {
            for &index in column.iter().rev() {
                let disc = &self.discs[index as usize];
                if disc.position.y < min.y - reach {
                    break;
                }
                if disc.position.y <= max.y + reach {
                    visit(index as usize, disc);
                }
            }
        }
    }

    fn column(&self, x: f64) -> usize {
        // A column more on either side holds the fixed discs that stand out beyond the walls.
        let at = ((x + self.half_width) / self.column_width).floor() + 1.0;
        at.clamp(0.0, (self.columns.len() - 1) as f64) as usize
    }

    fn columns_within(&self, x: f64, reach: f64) -> &[Vec<u32>] {
        &self.columns[self.column(x - reach)..=self.column(x + reach)]
    }
}
