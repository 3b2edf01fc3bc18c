//! A cell whose left and right borders are one and the same line: what leaves it on one side comes back on the other.

use glam::DVec2;
use serde::{Deserialize, Serialize};

/// Borders that wrap. All that a scene has is there again a period to the left and to the right, without end.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Periodic {
    /// x of the left and of the right border, m.
    pub x: [f64; 2],
}

impl Periodic {
    /// The period: the width of the cell, m.
    pub fn width(self) -> f64 {
        self.x[1] - self.x[0]
    }

    /// The image of a place that lies in the cell, the left border included, m. What is there stays to the last bit.
    pub fn wrap(self, place: DVec2) -> DVec2 {
        let [left, right] = self.x;
        if (left..right).contains(&place.x) {
            return place;
        }
        let x = place.x - self.width() * ((place.x - left) / self.width()).floor();
        // Rounding may end on the right border, which is the left one. What is no number stays none.
        DVec2::new(if x >= right || x < left { left } else { x }, place.y)
    }

    /// The shortest way between two places that are apart by `offset`, or by it and some periods, m. One that is
    /// shorter than half a period stays to the last bit.
    #[inline]
    pub fn shortest(self, offset: DVec2) -> DVec2 {
        let periods = (offset.x / self.width()).round();
        DVec2::new(offset.x - self.width() * periods, offset.y)
    }

    /// By how much a shape is to be moved (m) for its other images that reach into the cell, where it reaches from
    /// one x to another; a shape that lies in the cell but for rounding has none.
    pub(crate) fn images(self, [from, to]: [f64; 2]) -> impl Iterator<Item = DVec2> {
        let rounding = 1e-9 * self.width();
        let over_left = (from < self.x[0] - rounding).then_some(self.width());
        let over_right = (to > self.x[1] + rounding).then_some(-self.width());
        [over_left, over_right].into_iter().flatten().map(|by| DVec2::new(by, 0.0))
    }

    /// The image of a place that is nearest to another one, m.
    pub(crate) fn near(self, place: DVec2, other: DVec2) -> DVec2 {
        let periods = ((other.x - place.x) / self.width()).round();
        DVec2::new(place.x + self.width() * periods, place.y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CELL: Periodic = Periodic { x: [-0.3, 0.7] };

    #[test]
    fn a_place_is_wrapped_into_the_cell_and_one_inside_keeps_its_bits() {
        for (x, wrapped) in
            [(-0.3, -0.3), (0.1, 0.1), (0.7, -0.3), (0.8, -0.2), (-5.4, 0.6), (9.0, 0.0)]
        {
            let found = CELL.wrap(DVec2::new(x, 2.0));
            assert!((found.x - wrapped).abs() < 1e-14 && found.y == 2.0, "{x}: {found}");
            assert!((CELL.x[0]..CELL.x[1]).contains(&found.x));
        }
        let inside = 0.123_456_789;
        assert_eq!(CELL.wrap(DVec2::new(inside, 0.0)).x.to_bits(), inside.to_bits());
        // A hair left of the border is the right border but for rounding.
        let hair = CELL.wrap(DVec2::new(f64::from_bits((-0.3f64).to_bits() + 1), 0.0));
        assert!((CELL.x[0]..CELL.x[1]).contains(&hair.x));
        assert!(CELL.wrap(DVec2::NAN).x.is_nan());
    }

    #[test]
    fn the_shortest_way_is_that_to_the_nearest_image() {
        for (offset, shortest) in [(0.4, 0.4), (0.6, -0.4), (-0.9, 0.1), (3.2, 0.2)] {
            let found = CELL.shortest(DVec2::new(offset, 7.0));
            assert!((found.x - shortest).abs() < 1e-14 && found.y == 7.0, "{offset}: {found}");
        }
        let images: Vec<DVec2> = CELL.images([-0.4, 0.0]).chain(CELL.images([0.6, 0.8])).collect();
        assert_eq!(images, [DVec2::X, DVec2::NEG_X]);
        assert_eq!(CELL.images([-0.3, 0.7]).count(), 0);
    }
}
