//! Gap and normal between two bodies, and the time at which two freely moving bodies meet.
//!
//! **Time of impact.** The bodies are convex, so along a straight path the gap is a convex function of time. Its
//! tangent never exceeds it, so Newton's iteration approaches the first zero of the gap from below and never passes
//! it. If the bodies accelerate, the parabola with the present gap, speed and acceleration replaces the tangent. If
//! the gap begins to open before it is zero, the two bodies pass each other. The tangent at the beginning alone cannot
//! show this, so the iteration is needed.

use glam::DVec2;

use super::candidates::Candidates;
use super::numbering::{Numbering, Other};
use super::pair::Contact;
use crate::number::Parts;
use crate::world::World;

/// Largest number of Newton's iterations for one time of impact. The iterations converge quadratically, except if the
/// two bodies graze each other. In that case each of the first iterations only halves the error.
const MOST_STEPS: u32 = 60;
/// Gap, in radii of the grain, below which two bodies touch. It allows for rounding.
const ROUNDING_IN_RADII: f64 = 1e-13;

/// Returns the normal and the gap (m) between another body and a disc with the given centre and radius (m). `None` if
/// the nearest point is a shared corner at which another feature (part of a boundary) reports the contact.
#[inline(always)]
pub(super) fn approach(
    world: &World,
    candidates: &Candidates,
    position: DVec2,
    radius: f64,
    other: Other,
    axes: usize,
) -> Option<(DVec2, f64)> {
    let (centre, other_radius) = match other {
        Other::Grain(j) => (world.grains.positions[j], world.grains.radii[j]),
        Other::FixedDisc(disc) => {
            let disc = &world.fixed_discs[disc];
            (disc.position, disc.radius)
        }
        Other::Feature(feature) => {
            let found = candidates.distance(world, feature, position);
            return found.map(|(normal, distance)| (normal, distance - radius));
        }
    };
    let offset = world.shortest(position - centre);
    Some(disc_gap(offset, radius + other_radius, axes))
}

/// Returns the normal (from j to i) and the gap (m) of two discs. `offset` is the position of disc i relative to disc
/// j (m), and `radii` the sum of the two radii (m). If the centres coincide, the normal is along x, so that the step
/// stays finite.
#[inline(always)]
fn disc_gap(offset: DVec2, radii: f64, axes: usize) -> (DVec2, f64) {
    if axes == 1 {
        return (DVec2::new(1f64.copysign(offset.x), 0.0), offset.x.abs() - radii);
    }
    let distance = offset.length();
    let normal = if distance > 0.0 { offset / distance } else { DVec2::X };
    (normal, distance - radii)
}

impl Contact {
    /// Returns the gap of the contact at the present positions of its bodies, m. `None` if the grain now touches
    /// another feature (part of a boundary) instead.
    pub(crate) fn gap_now(&self, world: &World, near: &Candidates, axes: usize) -> Option<f64> {
        let (grain, other) = (self.grain as usize, Numbering::of(world).other(self.other));
        let (position, radius) = (world.grains.positions[grain], world.grains.radii[grain]);
        approach(world, near, position, radius, other, axes).map(|(_, gap)| gap)
    }
}

/// Criterion for adding pairs of bodies that do not touch yet to the contact list, because they may touch within the
/// step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LookAhead {
    /// Time step Δt, s.
    pub time_step_secs: f64,
    /// Distance, m. A pair of bodies is added to the contact list if its gap would shrink to less than this distance
    /// within the step.
    pub distance: f64,
    /// Largest gap, m. A pair of bodies with a larger gap is not added to the contact list, unless it is bonded.
    pub reach: f64,
    /// Criterion by which a contact counts as in touch, so that cohesion can pull.
    pub in_touch: InTouch,
}

/// Criterion by which a contact counts as in touch, so that cohesion can pull. The bodies of other contacts are only
/// near each other.
#[derive(Clone, Copy, Debug)]
pub(crate) enum InTouch {
    /// A pair is in touch if it touches when the step begins.
    Touching,
    /// A pair is in touch if it has touched before. It remains bonded, and in the contact list, until the bond breaks.
    Bonded,
    /// A pair is in touch if its gap is at most this length (m) when the step begins.
    Within(f64),
}

impl LookAhead {
    /// Returns a copy of this criterion with another rule for cohesion: all pairs with a gap of at most `range` (m)
    /// are in touch, so that cohesion can pull.
    pub(crate) fn pulling_within(self, range: f64) -> Self {
        Self {
            distance: self.distance.max(range),
            reach: self.reach.max(range),
            in_touch: InTouch::Within(range),
            ..self
        }
    }

    /// Returns the search margin of a grain with this velocity (m/s), m: the gap that the grain may close by its own
    /// speed within the step. If pairs stay bonded, it is half of `reach` (the largest gap of a contact), because
    /// bonds may be open even if their grains are slow.
    pub(crate) fn way_of_grain(&self, velocity: DVec2) -> f64 {
        /// Factor that makes the margin slightly larger than the computed motion of the grain, because the speed is
        /// rounded.
        const ROUNDING: f64 = 1.0 + 1e-9;
        match self.in_touch {
            InTouch::Bonded => 0.5 * self.reach,
            InTouch::Touching | InTouch::Within(_) => {
                let own = self.time_step_secs * velocity.length() + self.distance;
                ROUNDING * own.min(self.reach)
            }
        }
    }

    /// Returns the search margin of walls and fixed discs, m. `way_of_walls` is the distance by which the fastest of
    /// them moves in the step, m.
    pub(crate) fn way_of_others(&self, way_of_walls: f64) -> f64 {
        let of_bonds =
            if matches!(self.in_touch, InTouch::Bonded) { 0.5 * self.reach } else { 0.0 };
        of_bonds.max(way_of_walls.min(self.reach))
    }
}

/// Motion of a grain relative to the other body of a contact during a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RelativeMotion {
    /// Position of the grain relative to the other body at the time 0 of this motion, minus the present relative
    /// position, m.
    pub offset: DVec2,
    /// Relative velocity v at the time 0 of this motion, m/s.
    pub velocity: DVec2,
    /// Relative acceleration a, m/s², constant during the motion.
    pub acceleration: DVec2,
}

impl RelativeMotion {
    /// Returns the relative displacement from the present relative position after `secs` seconds, m.
    fn way(&self, secs: f64) -> DVec2 {
        self.offset + secs * (self.velocity + 0.5 * secs * self.acceleration)
    }

    /// Returns the relative velocity after `secs` seconds, m/s.
    pub(crate) fn velocity_at(&self, secs: f64) -> DVec2 {
        self.velocity + secs * self.acceleration
    }

    /// Returns the normal and the gap (m) of the two bodies after `secs` seconds. `None` if the nearest point is a
    /// shared corner at which another feature (part of a boundary) reports the contact.
    pub(crate) fn approach(
        &self,
        world: &World,
        candidates: &Candidates,
        contact: &Contact,
        secs: f64,
        axes: usize,
    ) -> Option<(DVec2, f64)> {
        let grain = contact.grain as usize;
        let (place, radius) = (world.grains.positions[grain], world.grains.radii[grain]);
        let other = Numbering::of(world).other(contact.other);
        approach(world, candidates, place + self.way(secs), radius, other, axes)
    }

    /// Returns the time of impact (the first time in the interval `from` to `to`, s, at which the two bodies touch)
    /// and the normal at that time. `None` if they do not meet.
    pub(crate) fn time_of_impact(
        &self,
        world: &World,
        candidates: &Candidates,
        contact: &Contact,
        [from, to]: [f64; 2],
        axes: usize,
    ) -> Option<(f64, DVec2)> {
        let rounding = ROUNDING_IN_RADII * world.grains.radii[contact.grain as usize];
        let mut secs = from;
        for _ in 0..MOST_STEPS {
            let (normal, gap) = self.approach(world, candidates, contact, secs, axes)?;
            let speed = normal.dot(self.velocity_at(secs));
            let acceleration = normal.dot(self.acceleration);
            if gap <= rounding && speed < 0.0 {
                return Some((secs, normal));
            }
            secs += first_zero(gap.positive_part(), speed, acceleration)?;
            if secs > to {
                return None;
            }
        }
        None
    }
}

/// Returns the first time h > 0, s, at which a gap (m) that opens with this speed (m/s) and acceleration (m/s²) is
/// zero. `None` if the gap never closes.
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
        // The gap ½·2·h² − 3h + 2 is zero at h = 1, and again at h = 2.
        assert_eq!(first_zero(2.0, -3.0, 2.0), Some(1.0));
        assert_eq!(first_zero(2.0, -1.0, 2.0), None);
        let h = first_zero(2.0, 1.0, -2.0).expect("it falls back");
        assert!((2.0 + h - h * h).abs() < 1e-15);
    }
}
