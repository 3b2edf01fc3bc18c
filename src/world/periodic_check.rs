//! Whether periodic borders go with what there is between them.

use glam::DVec2;

use super::{Boundary, Gravity, Motion, Periodic};
use crate::error::{Error, Result};

/// Narrowest cell, in diameters of its largest disc: in a narrower one a disc and its images leave no room to pass.
const LEAST_DIAMETERS: f64 = 3.0;
/// How far apart surfaces can be that feel each other, in mean diameters: above the longest bond
/// ([`Parameters::debonding_distance`](super::Parameters)).
const FELT_IN_DIAMETERS: f64 = 0.2;

impl Periodic {
    /// Checks it against what there is in a world, of which the radius of the largest disc and d are given, m.
    ///
    /// # Errors
    /// Names what does not fit.
    pub(crate) fn check(
        self,
        (boundaries, motions): (&[Boundary], &[Motion]),
        gravity: &Gravity,
        [largest_radius, mean_diameter]: [f64; 2],
    ) -> Result<()> {
        let [left, right] = self.x;
        let found = || format!("[{left}, {right}]");
        if !(left.is_finite() && right.is_finite() && self.width().is_finite()) {
            return Err(Error::value("periodic.x", found(), "two finite numbers of m"));
        }
        // No two images of a disc are felt by the same other one.
        let largest_diameter = 2.0 * largest_radius;
        let felt = FELT_IN_DIAMETERS * mean_diameter;
        let least = (LEAST_DIAMETERS * largest_diameter).max(2.0 * (largest_diameter + felt));
        if self.width().is_nan() || self.width() < least {
            let allowed = format!(
                "at least {least} m wide: {LEAST_DIAMETERS} times the largest diameter, and twice as far as discs \
                 feel each other"
            );
            return Err(Error::value("periodic.x", found(), allowed));
        }
        if matches!(gravity, Gravity::Attraction { .. }) {
            return Err(Error::value("periodic", "given", "left out where gravity is not uniform"));
        }
        let fits = |shape: &Boundary| match shape {
            Boundary::HalfSpace { normal, .. } | Boundary::Piston { normal, .. } => normal.x == 0.0,
            Boundary::Segment { from, to } => [from, to].iter().all(|place| self.holds(**place)),
            Boundary::Polyline { points } | Boundary::ConvexPolygon { points } => {
                points.iter().all(|place| self.holds(*place))
            }
        };
        if let Some(index) = boundaries.iter().position(|shape| !fits(shape)) {
            let found = format!("a {} that does not go on across it", boundaries[index].word());
            let allowed = "level, or between the borders of periodic.x";
            return Err(Error::value(format!("boundaries[{index}]"), found, allowed));
        }
        self.check_motions(boundaries, motions)
    }

    fn check_motions(self, boundaries: &[Boundary], motions: &[Motion]) -> Result<()> {
        for (index, motion) in motions.iter().enumerate() {
            let field = format!("motions[{index}].course");
            if motion.turns() {
                let allowed = "left out or along a line where borders are periodic";
                return Err(Error::value(field, "round a pivot", allowed));
            }
            let stays_level = |&boundary: &usize| boundaries[boundary].is_half_space();
            if motion.goes_along_x() && !motion.boundaries.iter().all(stays_level) {
                let allowed = "along y for shapes with ends where borders are periodic: fixed discs and half-spaces \
                               alone cross them";
                return Err(Error::value(field, "along x", allowed));
            }
        }
        Ok(())
    }

    fn holds(self, place: DVec2) -> bool {
        (self.x[0]..=self.x[1]).contains(&place.x)
    }
}
