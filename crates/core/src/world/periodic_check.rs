//! Checks that periodic borders are compatible with the bodies, boundaries and gravity of a scene.

use glam::DVec2;

use super::{Boundary, Gravity, Motion, Periodic, Physics};
use crate::error::{self, Error, Result};

/// Smallest allowed width or height of a periodic cell, in diameters of its largest disc. Then two discs of this size
/// fit side by side between a disc and the periodic image of this disc. In a narrower cell they could not pass each
/// other there.
const LEAST_DIAMETERS: f64 = 3.0;
/// Largest gap between two discs that can affect each other, in mean diameters. It is larger than the longest possible
/// bond ([`Parameters::debonding_distance`](super::Parameters)).
const FELT_IN_DIAMETERS: f64 = 0.2;

/// An axis with periodic borders.
#[derive(Clone, Copy)]
struct Wrapping {
    /// Name of the periodic borders in scene files and error messages: `periodic.x` or `periodic.y`.
    field: &'static str,
    /// Index of the axis: 0 for x, 1 for y.
    axis: usize,
    borders: [f64; 2],
}

impl Periodic {
    /// Checks that the periodic borders are compatible with the bodies, motions and gravity of a world. `lengths` are
    /// the radius of the largest disc and the mean diameter d, both in m.
    pub(crate) fn check(
        self,
        boundaries: &[Boundary],
        fixed_discs: usize,
        motions: &[Motion],
        gravity: &Gravity,
        physics: Physics,
        lengths: [f64; 2],
    ) -> Result<()> {
        let has_borders = self.x.is_some() || self.y.is_some() || self.is_sheared();
        error::check(has_borders, "periodic", "without borders", "given with x, y or both")?;
        let allowed = "left out where physics.axes is 1";
        error::check(self.y.is_none() || physics.axes != 1, "periodic.y", "given", allowed)?;
        for wrapping in self.wrapping() {
            wrapping.check_period(lengths)?;
        }
        if matches!(gravity, Gravity::Attraction { .. }) {
            return Err(Error::value("periodic", "given", "left out where gravity is not uniform"));
        }
        self.check_shear(boundaries.len() + fixed_discs, physics)?;
        for wrapping in self.wrapping() {
            wrapping.check_shapes(boundaries)?;
            wrapping.check_motions(boundaries, motions)?;
        }
        Ok(())
    }

    /// Checks sheared borders, beyond which the periodic images of the cell move along x or are shifted along x: the
    /// shear rate and the shift must be finite, both axes must be periodic, the physics must include friction and
    /// rotation, and there must be no boundaries or fixed discs.
    fn check_shear(self, fixed_bodies: usize, physics: Physics) -> Result<()> {
        let Self { shear_rate, shift, .. } = self;
        let numbers = [("periodic.shear_rate", shear_rate), ("periodic.shift", shift)];
        if let Some((field, found)) = numbers.into_iter().find(|(_, number)| !number.is_finite()) {
            return Err(Error::value(field, found, "a finite number"));
        }
        let allowed = "so small that the border's speed is a finite number";
        error::check(self.border_speed().is_finite(), "periodic.shear_rate", shear_rate, allowed)?;
        let Some((field, found)) = numbers.into_iter().find(|(_, number)| *number != 0.0) else {
            return Ok(());
        };
        let (Some([left, right]), Some(_)) = (self.x, self.y) else {
            let allowed = "0 unless both periodic.x and periodic.y are given";
            return Err(Error::value(field, found, allowed));
        };
        if shift.abs() > right - left {
            let allowed = format!("from -{0} to {0} m, a width of the cell", right - left);
            return Err(Error::value("periodic.shift", shift, allowed));
        }
        if !(physics.friction && physics.rotation) {
            let allowed = "0 unless physics has friction and rotation; mu = 0 is no matter";
            return Err(Error::value(field, found, allowed));
        }
        let allowed = "0 where there are boundaries or fixed discs, which cannot go with it";
        error::check(fixed_bodies == 0, field, found, allowed)
    }

    fn wrapping(self) -> impl Iterator<Item = Wrapping> {
        let of = |(axis, (field, borders)): (usize, (&'static str, Option<[f64; 2]>))| {
            borders.map(|borders| Wrapping { field, axis, borders })
        };
        [("periodic.x", self.x), ("periodic.y", self.y)].into_iter().enumerate().filter_map(of)
    }
}

impl Wrapping {
    fn check_period(self, [largest_radius, mean_diameter]: [f64; 2]) -> Result<()> {
        let [low, high] = self.borders;
        let found = || format!("[{low}, {high}]");
        let period = high - low;
        if !(low.is_finite() && high.is_finite() && period.is_finite()) {
            return Err(Error::value(self.field, found(), "two finite numbers of m"));
        }
        // A disc must not interact with two periodic images of the same other disc.
        let largest_diameter = 2.0 * largest_radius;
        let felt = FELT_IN_DIAMETERS * mean_diameter;
        let least = (LEAST_DIAMETERS * largest_diameter).max(2.0 * (largest_diameter + felt));
        if period.is_nan() || period < least {
            let size = ["wide", "high"][self.axis];
            let allowed = format!(
                "at least {least} m {size}: {LEAST_DIAMETERS} times the largest diameter, and twice as far as discs \
                 feel each other"
            );
            return Err(Error::value(self.field, found(), allowed));
        }
        Ok(())
    }

    fn check_shapes(self, boundaries: &[Boundary]) -> Result<()> {
        let fits = |shape: &Boundary| match shape {
            Boundary::HalfSpace { normal, .. } | Boundary::Piston { normal, .. } => {
                normal[self.axis] == 0.0
            }
            Boundary::Segment { from, to } => [from, to].iter().all(|place| self.holds(**place)),
            Boundary::Polyline { points } | Boundary::ConvexPolygon { points } => {
                points.iter().all(|place| self.holds(*place))
            }
        };
        if let Some(index) = boundaries.iter().position(|shape| !fits(shape)) {
            let found = format!("a {} that does not go on across it", boundaries[index].word());
            let along = ["level", "upright"][self.axis];
            let allowed = format!("{along}, or between the borders of {}", self.field);
            return Err(Error::value(format!("boundaries[{index}]"), found, allowed));
        }
        Ok(())
    }

    fn check_motions(self, boundaries: &[Boundary], motions: &[Motion]) -> Result<()> {
        for (index, motion) in motions.iter().enumerate() {
            let field = format!("motions[{index}].course");
            if motion.turns() {
                let allowed = "left out or along a line where borders are periodic";
                return Err(Error::value(field, "round a pivot", allowed));
            }
            let goes_on = |&boundary: &usize| boundaries[boundary].is_half_space();
            if motion.goes_along(self.axis) && !motion.boundaries.iter().all(goes_on) {
                let [along, across] = [["along x", "along y"], ["along y", "along x"]][self.axis];
                let allowed = format!(
                    "{across} for shapes with ends where borders are periodic: fixed discs and half-spaces alone \
                     cross them"
                );
                return Err(Error::value(field, along, allowed));
            }
        }
        Ok(())
    }

    fn holds(self, place: DVec2) -> bool {
        let [low, high] = self.borders;
        (low..=high).contains(&place[self.axis])
    }
}
