//! Periodic cells: copies of the cell (periodic images) continue it beyond its borders, so that a grain that leaves on
//! one side re-enters on the opposite side.
//!
//! **Sheared borders.** The images of the cell above and below it slide along x, so that the grains flow without walls
//! (A. W. Lees, S. F. Edwards, *The computer study of transport processes under extreme conditions*, J. Phys. C 5,
//! 1972). The image k heights above the cell is shifted by k·s along x (m), and moves along x at the speed k·U (m/s):
//!
//! > U = γ̇ L_y,  ds/dt = U,  and s is equivalent to s − L_x,
//!
//! with the shear rate γ̇ (1/s), the width L_x and the height L_y (m) of the cell. So the image of a grain in the
//! cell k heights above is at x + (k s, k L_y) and has the velocity v + (k U, 0). A grain that leaves through the
//! upper border re-enters as its image from the cell below: its x is reduced by s and its v_x by U. The position of
//! the borders does not matter: moving them only adds a constant velocity to the flow.
//!
//! **Offsets** between two points are reduced to the shortest vector in two steps. The first step counts the whole
//! cell heights in the offset and subtracts the shift s of that many cells. Then each axis wraps separately. The
//! result is the nearest image for any pair that is less than half a height apart, and so for any touching pair.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::number::is_zero;

/// Periodic borders: left and right, below and above, or both. The scene repeats endlessly with the period of the
/// cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Periodic {
    /// x of the left and the right border, m. `None` if the cell is not periodic along x.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub x: Option<[f64; 2]>,
    /// y of the lower and the upper border, m. `None` if the cell is not periodic along y.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub y: Option<[f64; 2]>,
    /// Shear rate γ̇ of sheared borders, 1/s. The periodic image of the cell directly above moves along x at γ̇ times
    /// the height of the cell. 0 if the borders are not sheared.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub shear_rate: f64,
    /// Present shift along x of the periodic image of the cell directly above, m; 0 if this image is not shifted. The
    /// shift changes with time if `shear_rate` is not 0. In a scene it is at most one width of the cell to either side.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub shift: f64,
}

impl Periodic {
    /// Returns a cell with periodic left and right borders at these x coordinates, m.
    pub const fn along_x(x: [f64; 2]) -> Self {
        Self { x: Some(x), y: None, shear_rate: 0.0, shift: 0.0 }
    }

    /// Returns a cell with four periodic borders at these x and y coordinates, m.
    pub const fn along_both(x: [f64; 2], y: [f64; 2]) -> Self {
        Self { x: Some(x), y: Some(y), shear_rate: 0.0, shift: 0.0 }
    }

    /// Returns the width and the height of the periodic cell, m. `None` for an axis without periodic borders.
    pub fn periods(self) -> [Option<f64>; 2] {
        [self.x, self.y].map(|borders| borders.map(period))
    }

    /// Returns a vector whose component is 1 along each axis with periodic borders, and 0 along each other axis.
    pub(crate) fn axes(self) -> DVec2 {
        DVec2::from(self.periods().map(|period| if period.is_some() { 1.0 } else { 0.0 }))
    }

    /// Returns the lower left and the upper right corner of the box with the given corners, m, extended or reduced
    /// along each periodic axis to the borders of the periodic cell.
    pub fn borders_or(self, [low, high]: [DVec2; 2]) -> [DVec2; 2] {
        let [left, right] = self.x.unwrap_or([low.x, high.x]);
        let [below, above] = self.y.unwrap_or([low.y, high.y]);
        [DVec2::new(left, below), DVec2::new(right, above)]
    }

    /// Returns the one periodic image of a point that is inside the periodic cell, m. The left and the lower border
    /// belong to the cell. A point that is already in the cell is returned unchanged, bit for bit.
    pub fn wrap(self, place: DVec2) -> DVec2 {
        let x = match self.is_sheared() {
            true => place.x - self.lean(self.cells_above(place.y)),
            false => place.x,
        };
        DVec2::new(wrapped(self.x, x), wrapped(self.y, place.y))
    }

    /// Returns the shortest of the vectors that differ from `offset` by whole periods, m. An offset below half a
    /// period is returned unchanged, bit for bit.
    #[inline]
    pub fn shortest(self, offset: DVec2) -> DVec2 {
        let offset = if self.is_sheared() { self.upright(offset) } else { offset };
        DVec2::new(shortest(self.x, offset.x), shortest(self.y, offset.y))
    }

    /// Returns the number of whole periods along each axis by which `offset` (m) differs from the shortest equivalent
    /// vector. 0 along axes without periodic borders.
    pub(crate) fn whole(self, offset: DVec2) -> DVec2 {
        let offset = if self.is_sheared() { self.upright(offset) } else { offset };
        DVec2::new(periods_in(self.x, offset.x), periods_in(self.y, offset.y))
    }

    /// Returns the displacements (m) by which periodic images of a shape differ from the shape, for all images that
    /// extend into the periodic cell. The shape itself is not one of them. The arguments are the corners of the
    /// bounding box of the shape. A shape that is inside the cell, except for rounding, has no such images.
    pub fn images(self, [low, high]: [DVec2; 2]) -> impl Iterator<Item = DVec2> {
        let middle = 0.5 * (low.x + high.x);
        let along_y = reaching(self.y, [low.y, high.y]).into_iter().flatten();
        let all = along_y.flat_map(move |y| {
            let lean = self.lean_into_cell(middle, y);
            let along_x = reaching(self.x, [low.x + lean, high.x + lean]).into_iter().flatten();
            along_x.map(move |x| DVec2::new(lean + x, y))
        });
        all.filter(|by| *by != DVec2::ZERO)
    }

    /// Returns the displacements (m) from a point to itself and to its periodic images one period to either side along
    /// each axis.
    pub fn around(self) -> impl Iterator<Item = DVec2> {
        let [along_x, along_y] =
            self.periods().map(|period| [Some(0.0), period, period.map(|by| -by)]);
        along_y.into_iter().flatten().flat_map(move |y| {
            let lean = self.lean_of(y);
            along_x.into_iter().flatten().map(move |x| DVec2::new(lean + x, y))
        })
    }

    /// Returns the periodic image of the point `place` that is nearest to the point `other`, m.
    pub fn near(self, place: DVec2, other: DVec2) -> DVec2 {
        if self.is_sheared() {
            return other - self.shortest(other - place);
        }
        let along = |borders: Option<[f64; 2]>, [place, other]: [f64; 2]| match borders {
            None => place,
            Some(borders) => {
                let period = period(borders);
                place + period * ((other - place) / period).round()
            }
        };
        DVec2::new(along(self.x, [place.x, other.x]), along(self.y, [place.y, other.y]))
    }
}

pub(super) fn period([low, high]: [f64; 2]) -> f64 {
    high - low
}

/// Returns the number of whole periods in an offset (m), rounded to the nearest integer. 0 for an axis without
/// periodic borders.
#[inline]
pub(super) fn periods_in(borders: Option<[f64; 2]>, offset: f64) -> f64 {
    borders.map_or(0.0, |borders| (offset / period(borders)).round())
}

pub(super) fn wrapped(borders: Option<[f64; 2]>, at: f64) -> f64 {
    let Some([low, high]) = borders.filter(|[low, high]| !(*low..*high).contains(&at)) else {
        return at;
    };
    let wrapped = at - (high - low) * ((at - low) / (high - low)).floor();
    // Rounding may give the upper border, which is equivalent to the lower border. NaN stays NaN.
    if wrapped >= high || wrapped < low { low } else { wrapped }
}

#[inline]
pub(super) fn shortest(borders: Option<[f64; 2]>, offset: f64) -> f64 {
    borders.map_or(offset, |borders| {
        let period = period(borders);
        offset - period * (offset / period).round()
    })
}

/// Returns the displacements (m) along one axis by which periodic images of an interval differ from the interval, for
/// all images that overlap the periodic cell. The first displacement is 0, for the interval itself.
fn reaching(borders: Option<[f64; 2]>, [from, to]: [f64; 2]) -> [Option<f64>; 3] {
    let over = borders.map_or([None; 2], |[low, high]| {
        let period = high - low;
        let rounding = 1e-9 * period;
        [(from < low - rounding).then_some(period), (to > high + rounding).then_some(-period)]
    });
    [Some(0.0), over[0], over[1]]
}

impl Periodic {
    /// True if the periodic cell has sheared borders: its periodic images above and below move along x or are shifted
    /// along x.
    #[inline(always)]
    pub fn is_sheared(self) -> bool {
        self.shear_rate != 0.0 || self.shift != 0.0
    }

    /// Returns the speed U along x of the periodic image of the cell directly above, m/s.
    pub fn border_speed(self) -> f64 {
        self.shear_rate * self.y.map_or(0.0, period)
    }

    /// Returns the speed along x of a periodic image of a disc relative to the disc itself, m/s. The image is the one
    /// that is nearest to another disc, and `offset` (m) is the vector from the disc to this other disc.
    #[inline]
    pub(crate) fn speed_of_image(self, offset: DVec2) -> f64 {
        self.border_speed() * periods_in(self.y, offset.y)
    }

    /// Updates the shift of the periodic images above and below, which move along x, after `secs` seconds.
    pub(crate) fn slide(&mut self, secs: f64) {
        if self.shear_rate != 0.0 {
            self.shift = shortest(self.x, self.shift + secs * self.border_speed());
        }
    }

    /// Returns `offset` (m) without the shift along x that comes from sheared borders, beyond which the periodic images
    /// of the cell are shifted along x. The removed shift is the shift from one image to the next, times the number of
    /// whole cell heights in the offset.
    #[inline]
    pub(super) fn upright(self, offset: DVec2) -> DVec2 {
        DVec2::new(offset.x - self.lean(periods_in(self.y, offset.y)), offset.y)
    }

    /// Returns the number of cell heights by which a point at the height `y` (m) is above its image in the periodic
    /// cell: 0 in the cell itself, 1 in the periodic image directly above it.
    pub(super) fn cells_above(self, y: f64) -> f64 {
        periods_in(self.y, y - wrapped(self.y, y))
    }

    /// Returns the shift along x, m, of the periodic image of the cell that is `cells` cell heights higher.
    #[inline]
    pub(super) fn lean(self, cells: f64) -> f64 {
        cells * self.shift
    }

    /// Returns the shift along x, m, of the periodic image of the cell that is `height` (m) higher.
    pub(super) fn lean_of(self, height: f64) -> f64 {
        self.lean(periods_in(self.y, height))
    }

    /// Returns the shift along x, m, of the periodic image of the cell that is `height` (m) higher. It is reduced by
    /// whole cell widths so that a point at `x` (m) is in the cell after the shift.
    pub(crate) fn lean_into_cell(self, x: f64, height: f64) -> f64 {
        let lean = self.lean_of(height);
        if lean == 0.0 { 0.0 } else { wrapped(self.x, x + lean) - x }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CELL: Periodic = Periodic::along_x([-0.3, 0.7]);
    const BOTH: Periodic = Periodic { y: Some([2.0, 4.0]), ..CELL };

    #[test]
    fn a_place_is_wrapped_into_the_cell_and_one_inside_keeps_its_bits() {
        for (x, wrapped) in
            [(-0.3, -0.3), (0.1, 0.1), (0.7, -0.3), (0.8, -0.2), (-5.4, 0.6), (9.0, 0.0)]
        {
            let found = CELL.wrap(DVec2::new(x, 2.0));
            assert!((found.x - wrapped).abs() < 1e-14 && found.y == 2.0, "{x}: {found}");
            assert!((-0.3..0.7).contains(&found.x));
        }
        let inside = 0.123_456_789;
        assert_eq!(CELL.wrap(DVec2::new(inside, 0.0)).x.to_bits(), inside.to_bits());
        // A point that is outside the left border only by rounding must still be mapped into the cell.
        let hair = CELL.wrap(DVec2::new(f64::from_bits((-0.3f64).to_bits() + 1), 0.0));
        assert!((-0.3..0.7).contains(&hair.x));
        assert!(CELL.wrap(DVec2::NAN).x.is_nan());
        let found = BOTH.wrap(DVec2::new(0.8, 1.5));
        assert!(found.distance(DVec2::new(-0.2, 3.5)) < 1e-14, "{found}");
    }

    #[test]
    fn the_shortest_way_is_that_to_the_nearest_image() {
        for (offset, shortest) in [(0.4, 0.4), (0.6, -0.4), (-0.9, 0.1), (3.2, 0.2)] {
            let found = CELL.shortest(DVec2::new(offset, 7.0));
            assert!((found.x - shortest).abs() < 1e-14 && found.y == 7.0, "{offset}: {found}");
            let found = BOTH.shortest(DVec2::new(offset, -2.0 * offset));
            let shortest = DVec2::new(shortest, -2.0 * shortest);
            assert!(found.distance(shortest) < 1e-14, "{offset}: {found}");
        }
    }

    #[test]
    fn what_reaches_over_a_corner_has_three_images() {
        let reach = |from: f64, to: f64| [DVec2::splat(from), DVec2::splat(to)];
        let images: Vec<DVec2> =
            CELL.images(reach(-0.4, 0.0)).chain(CELL.images(reach(0.6, 0.8))).collect();
        assert_eq!(images, [DVec2::X, DVec2::NEG_X]);
        assert_eq!(CELL.images(reach(-0.3, 0.7)).count(), 0);
        let corner = [DVec2::new(0.6, 1.9), DVec2::new(0.8, 2.1)];
        let images: Vec<DVec2> = BOTH.images(corner).collect();
        assert_eq!(images, [DVec2::NEG_X, DVec2::new(0.0, 2.0), DVec2::new(-1.0, 2.0)]);
        assert_eq!((CELL.around().count(), BOTH.around().count()), (3, 9));
    }

    const SHEARED: Periodic =
        Periodic { x: Some([-0.3, 0.7]), y: Some([2.0, 4.0]), shear_rate: 1.5, shift: 0.0 };

    #[test]
    fn a_place_comes_back_as_the_image_that_its_cell_has() {
        let cell = Periodic { shift: 0.25, ..SHEARED };
        for (place, expected) in [
            ([0.1, 3.0], [0.1, 3.0]),
            ([0.1, 4.5], [-0.15, 2.5]),
            ([0.1, 8.5], [0.35, 2.5]),
            ([0.6, 1.5], [-0.15, 3.5]),
            ([0.8, 3.0], [-0.2, 3.0]),
        ] {
            let found = cell.wrap(place.into());
            let expected = DVec2::from(expected);
            assert!(found.distance(expected) < 1e-14, "{place:?}: {found} {expected}");
            assert_eq!(cell.wrap(found), found);
        }
    }

    #[test]
    fn offsets_are_those_of_the_nearest_image_wherever_the_cells_have_slid() {
        for step in 0..40 {
            let mut cell = SHEARED;
            cell.slide(f64::from(step) * 0.0371);
            assert!(cell.shift.abs() <= 0.5, "{}", cell.shift);
            for k in 0..200 {
                let turn = f64::from(k) * 0.7;
                // The offset is shorter than half a width, so it is the offset to the nearest image.
                let short = 0.49 * (0.1 + 0.9 * f64::from(k) / 200.0) * DVec2::from_angle(turn);
                for (by_x, by_y) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (-2.0, 1.0), (1.0, -2.0)] {
                    let image = DVec2::new(by_x + by_y * cell.shift, 2.0 * by_y);
                    let found = cell.shortest(short + image);
                    assert!(found.distance(short) < 1e-12, "{short} {image}: {found}");
                    assert_eq!(cell.whole(short + image).y, by_y);
                    assert_eq!(cell.speed_of_image(short + image), 3.0 * by_y);
                    let near =
                        cell.near(DVec2::new(0.2, 3.0), DVec2::new(0.2, 3.0) + short + image);
                    assert!(near.distance(DVec2::new(0.2, 3.0) + image) < 1e-12, "{near}");
                }
            }
        }
    }

    #[test]
    fn images_beyond_the_upper_border_lean_and_reach_into_the_cell() {
        let cell = Periodic { shift: 0.4, ..SHEARED };
        let reach = |x: f64, y: f64| [DVec2::new(x, y) - 0.1, DVec2::new(x, y) + 0.1];
        let found = |x: f64, y: f64| cell.images(reach(x, y)).collect::<Vec<DVec2>>();
        assert_eq!(found(0.1, 3.0), []);
        let near = |found: Vec<DVec2>, expected: &[[f64; 2]]| {
            assert_eq!(found.len(), expected.len(), "{found:?}");
            for (found, expected) in found.into_iter().zip(expected) {
                assert!(found.distance(DVec2::from(*expected)) < 1e-12, "{found} {expected:?}");
            }
        };
        // An image of a disc that is partly below the cell appears at the top of the cell, shifted by 0.4.
        near(found(0.1, 2.05), &[[0.4, 2.0]]);
        // The next disc also has an image that crosses the right border.
        near(found(0.25, 2.05), &[[0.4, 2.0], [-0.6, 2.0]]);
        near(found(0.5, 2.05), &[[-0.6, 2.0]]);
        near(found(0.5, 3.95), &[[-0.4, -2.0]]);
        assert_eq!(cell.around().count(), 9);
    }
}
