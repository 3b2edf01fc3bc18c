//! When two bodies meet that nothing holds, and along which normal.
//!
//! **When the gap closes.** A body is convex, and so is the distance to it along a straight way: the tangent
//! of the gap is never above it, and Newton's steps come to its first zero from below without passing it.
//! With an acceleration the parabola of gap, speed and acceleration takes the tangent's place. Where the
//! gap no longer closes the two pass by each other, which the tangent at the beginning alone cannot tell.

use glam::DVec2;

use super::approach::approach;
use super::candidates::Candidates;
use super::contact_list::Contact;
use super::numbering::Numbering;
use crate::world::World;

/// Newton's steps to a meeting at the most. They converge quadratically, but where two bodies graze each
/// other by halves at first.
const MOST_STEPS: u32 = 60;
/// A gap that is none but for rounding, in radii.
const ROUNDING_IN_RADII: f64 = 1e-13;

/// How a grain goes relative to the other body of a contact, from the beginning of a step on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Course {
    /// Where it would have begun to be where it is now, m off its place.
    pub offset: DVec2,
    /// v, m/s.
    pub velocity: DVec2,
    /// a, m/s².
    pub acceleration: DVec2,
}

impl Course {
    /// x(s) − x, m.
    fn way(&self, secs: f64) -> DVec2 {
        self.offset + secs * (self.velocity + 0.5 * secs * self.acceleration)
    }

    /// The velocity at s, m/s.
    pub(crate) fn velocity_at(&self, secs: f64) -> DVec2 {
        self.velocity + secs * self.acceleration
    }

    /// Normal and gap at s, or nothing where another feature tells of the touched point.
    pub(crate) fn approach<const AXES: usize>(
        &self,
        world: &World,
        candidates: &Candidates,
        contact: &Contact,
        secs: f64,
    ) -> Option<(DVec2, f64)> {
        let grain = contact.grain as usize;
        let disc = (world.grains.positions[grain] + self.way(secs), world.grains.radii[grain]);
        approach::<AXES>(world, candidates, disc, Numbering::of(world).other(contact.other))
    }

    /// The first moment from one to another (s) at which the two touch, and their normal then.
    pub(crate) fn meeting<const AXES: usize>(
        &self,
        world: &World,
        candidates: &Candidates,
        contact: &Contact,
        [from, to]: [f64; 2],
    ) -> Option<(f64, DVec2)> {
        let rounding = ROUNDING_IN_RADII * world.grains.radii[contact.grain as usize];
        let mut secs = from;
        for _ in 0..MOST_STEPS {
            let (normal, gap) = self.approach::<AXES>(world, candidates, contact, secs)?;
            let speed = normal.dot(self.velocity_at(secs));
            let acceleration = normal.dot(self.acceleration);
            if gap <= rounding && speed < 0.0 {
                return Some((secs, normal));
            }
            secs += first_zero(gap.max(0.0), speed, acceleration)?;
            if secs > to {
                return None;
            }
        }
        None
    }
}

/// The first h > 0, s, at which a gap (m) that opens with a speed (m/s) and an acceleration (m/s²) is none.
fn first_zero(gap: f64, speed: f64, acceleration: f64) -> Option<f64> {
    let squared = speed * speed - 2.0 * acceleration * gap;
    if squared < 0.0 {
        return None;
    }
    let root = squared.sqrt();
    if speed < 0.0 {
        return Some(2.0 * gap / (root - speed));
    }
    (acceleration < 0.0).then(|| (speed + root) / -acceleration)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gap_that_opens_closes_again_under_a_pull_alone() {
        assert_eq!(first_zero(2.0, -1.0, 0.0), Some(2.0));
        assert_eq!(first_zero(2.0, 1.0, 0.0), None);
        assert_eq!(first_zero(0.0, 3.0, -2.0), Some(3.0));
        // ½·2·h² − 3h + 2: at h = 1 before it is back at h = 2.
        assert_eq!(first_zero(2.0, -3.0, 2.0), Some(1.0));
        assert_eq!(first_zero(2.0, -1.0, 2.0), None);
        let h = first_zero(2.0, 1.0, -2.0).expect("it falls back");
        assert!((2.0 + h - h * h).abs() < 1e-15);
    }
}
