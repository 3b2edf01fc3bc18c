//! Borders that shear: layers of cells that slide over one another, so that what fills them flows without walls
//! (A. W. Lees, S. F. Edwards, *The computer study of transport processes under extreme conditions*, J. Phys. C 5, 1972).
//!
//! The cell that is k heights above this one is off it by k·s along x, and goes along x with k·U relative to it:
//!
//! > U = γ̇ L_y,  ds/dt = U,  and s is the same as s − L_x.
//!
//! So the image of a grain there is at x + (k s, k L_y) and goes with v + (k U, 0), and a grain that leaves through the
//! upper border comes back as that of its images that the cell below has: its x lessened by s, and its v_x by U. No
//! place is marked by the borders: wherever they are drawn, the flow is the same but for the velocity that is added.
//!
//! **Offsets** are taken upright, their whole heights with the lean of those undone, and then each axis wraps by itself.
//! The image so found is the nearest one for all that is less than half a height apart, and so for all that touches.

use glam::DVec2;

use super::World;
use super::periodic::{Periodic, period, periods_in, shortest, wrapped};

impl Periodic {
    /// Whether the cells above and below are not straight above and below, or do not stay there.
    #[inline(always)]
    pub fn is_sheared(self) -> bool {
        self.shear_rate != 0.0 || self.shift != 0.0
    }

    /// U, m/s.
    pub fn border_speed(self) -> f64 {
        self.shear_rate * self.y.map_or(0.0, period)
    }

    /// How fast the nearest image of a disc goes beside the disc itself, where another one is off the disc by
    /// `offset` (m), m/s along x.
    #[inline]
    pub(crate) fn speed_of_image(self, offset: DVec2) -> f64 {
        self.border_speed() * periods_in(self.y, offset.y)
    }

    /// Lets the cells slide for `secs`.
    pub(crate) fn slide(&mut self, secs: f64) {
        if self.shear_rate != 0.0 {
            self.shift = shortest(self.x, self.shift + secs * self.border_speed());
        }
    }

    /// An offset with the lean of its whole heights undone.
    #[inline]
    pub(super) fn upright(self, offset: DVec2) -> DVec2 {
        DVec2::new(offset.x - self.lean(periods_in(self.y, offset.y)), offset.y)
    }

    /// How many cells above this one a height is.
    pub(super) fn cells_above(self, y: f64) -> f64 {
        periods_in(self.y, y - wrapped(self.y, y))
    }

    /// How far the cell that many above this one is off it, m.
    #[inline]
    pub(super) fn lean(self, cells: f64) -> f64 {
        cells * self.shift
    }

    /// The same of the cell that is so far (m) above this one.
    pub(super) fn lean_of(self, height: f64) -> f64 {
        self.lean(periods_in(self.y, height))
    }

    /// The same, but for as many widths as bring what is about a place (its x, m) into the cell.
    pub(crate) fn lean_into_cell(self, x: f64, height: f64) -> f64 {
        let lean = self.lean_of(height);
        if lean == 0.0 { 0.0 } else { wrapped(self.x, x + lean) - x }
    }
}

impl World {
    /// How fast the image of grain `j` goes that is nearest to grain `i`, beside grain `j` itself, m/s along x; 0
    /// where no border shears.
    #[inline]
    pub(crate) fn speed_of_image(&self, i: usize, j: usize) -> f64 {
        let places = &self.grains.positions;
        self.periodic.map_or(0.0, |periodic| periodic.speed_of_image(places[i] - places[j]))
    }

    /// Brings all discs back into the cell, where there is one. Gives the work that this did on grains, J: where
    /// borders shear, velocities change with the places.
    pub(crate) fn wrap(&mut self) -> f64 {
        let Some(periodic) = self.periodic else { return 0.0 };
        let mut work = 0.0;
        if periodic.is_sheared() {
            let grains = &mut self.grains;
            let moving = grains.positions.iter().zip(&mut grains.velocities).zip(&grains.masses);
            for ((place, velocity), mass) in moving {
                let change = -periodic.border_speed() * periodic.cells_above(place.y);
                work += mass * change * (velocity.x + 0.5 * change);
                velocity.x += change;
            }
        }
        let fixed = self.fixed_discs.iter_mut().map(|disc| &mut disc.position);
        for place in self.grains.positions.iter_mut().chain(fixed) {
            *place = periodic.wrap(*place);
        }
        work
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CELL: Periodic =
        Periodic { x: Some([-0.3, 0.7]), y: Some([2.0, 4.0]), shear_rate: 1.5, shift: 0.0 };

    #[test]
    fn a_place_comes_back_as_the_image_that_its_cell_has() {
        let cell = Periodic { shift: 0.25, ..CELL };
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
            let mut cell = CELL;
            cell.slide(f64::from(step) * 0.0371);
            assert!(cell.shift.abs() <= 0.5, "{}", cell.shift);
            for k in 0..200 {
                let turn = f64::from(k) * 0.7;
                // No farther than half a width: then it is the nearest of all images.
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
        let cell = Periodic { shift: 0.4, ..CELL };
        let reach = |x: f64, y: f64| [DVec2::new(x, y) - 0.1, DVec2::new(x, y) + 0.1];
        let found = |x: f64, y: f64| cell.images(reach(x, y)).collect::<Vec<DVec2>>();
        assert_eq!(found(0.1, 3.0), []);
        let near = |found: Vec<DVec2>, expected: &[[f64; 2]]| {
            assert_eq!(found.len(), expected.len(), "{found:?}");
            for (found, expected) in found.into_iter().zip(expected) {
                assert!(found.distance(DVec2::from(*expected)) < 1e-12, "{found} {expected:?}");
            }
        };
        // What is half below the cell is seen at the top of it, 0.4 on.
        near(found(0.1, 2.05), &[[0.4, 2.0]]);
        // There it straddles the right border.
        near(found(0.25, 2.05), &[[0.4, 2.0], [-0.6, 2.0]]);
        near(found(0.5, 2.05), &[[-0.6, 2.0]]);
        near(found(0.5, 3.95), &[[-0.4, -2.0]]);
        assert_eq!(cell.around().count(), 9);
    }
}
