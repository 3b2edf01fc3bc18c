//! Gap and normal between two bodies, and the time at which two freely moving bodies meet.
//!
//! **Time of impact.** The bodies are convex, so the gap between two bodies on straight paths is a convex function of
//! time. A tangent to the graph of this function is nowhere above the graph. So Newton's iteration approaches the first
//! time at which the gap is zero from earlier times, and never passes it. If the bodies accelerate, a parabola with the
//! gap, speed and acceleration at the present iterate replaces the tangent. If the gap begins to open before it is
//! zero, the two bodies pass each other. A single tangent, at the beginning of the path, cannot show whether the bodies
//! meet or pass each other, so an iteration is needed.

use glam::DVec2;

use super::candidates::Candidates;
use super::numbering::{Numbering, Other};
use super::pair::Contact;
use crate::number::Parts;
use crate::world::World;

/// Largest number of Newton's iterations for one time of impact. The iterations converge quadratically, except if the
/// two bodies graze each other. In that case each of the first iterations only halves the error, and 60 halvings reduce
/// it to rounding errors.
const MOST_STEPS: u32 = 60;
/// Gap, divided by the radius of the grain of the contact, below which the grain counts as touching the other body. It
/// allows for rounding errors.
const ROUNDING_IN_RADII: f64 = 1e-13;

/// Returns the gap (m) between another body and a disc with the given centre and radius (m), and the unit normal from
/// the other body to the disc. `None` if the other body is a wall part, the point of it that is nearest to the disc is
/// a corner which it shares with a second wall part, and a contact at this corner counts for the second part.
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
    /// Returns the gap of the contact at the present positions of its bodies, m. `None` if the other body is a wall
    /// part, the point of it that is nearest to the grain is now a corner which it shares with a second wall part, and
    /// a contact at this corner counts for the second part.
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
    /// Distance, m. A pair of bodies that do not touch is added to the contact list if its gap is less than this
    /// distance, after the closing motion of the bodies in one step at their present velocities is subtracted.
    pub distance: f64,
    /// Largest gap, m. A pair of bodies with a larger gap is not added to the contact list, unless it is bonded.
    pub reach: f64,
    /// Criterion by which a pair of bodies in the contact list counts as in touch (it touches, or its bond exists), so
    /// that cohesion acts between them.
    pub in_touch: InTouch,
}

/// Criterion by which a pair of bodies in the contact list counts as in touch (it touches, or its bond exists).
/// Cohesion acts only between bodies that are in touch. All other pairs in the list may touch within the step, but do
/// not touch yet.
#[derive(Clone, Copy, Debug)]
pub(crate) enum InTouch {
    /// Two bodies are in touch, so that cohesion acts between them, if their gap is closed when the step begins.
    Touching,
    /// Two bodies are in touch, so that cohesion acts between them, from the step in which they first touch until the
    /// bond between them breaks. The gap may open in the meantime.
    Bonded,
    /// Two bodies are in touch, so that cohesion acts between them, if their gap is at most this length (m) when the
    /// step begins.
    Within(f64),
}

impl LookAhead {
    /// Returns a copy of this criterion for the contacts of a step, changed so that cohesion acts between all pairs of
    /// bodies with a gap of at most `range` (m). If the search for contacts ended at a smaller gap, it is extended to
    /// `range`.
    pub(crate) fn pulling_within(self, range: f64) -> Self {
        Self {
            distance: self.distance.max(range),
            reach: self.reach.max(range),
            in_touch: InTouch::Within(range),
            ..self
        }
    }

    /// Returns the search margin of a grain with this velocity (m/s), m: the distance by which the grain moves in the
    /// step at this velocity, plus the length `distance`, and at most `reach` (the largest gap of a contact). If the
    /// contact law has bonds that exist until they break ([`InTouch::Bonded`]), the margin is half of `reach` for every
    /// grain, because a bond may be open although its grains are slow.
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

    /// Returns the search margin of walls and fixed discs, m: the distance by which a gap may be closed by their motion
    /// within the step, and at most `reach` (the largest gap of a contact). `way_of_walls` is the distance by which the
    /// fastest of them moves in the step, m. If the contact law has bonds that exist until they break, the margin is at
    /// least half of `reach`.
    pub(crate) fn way_of_others(&self, way_of_walls: f64) -> f64 {
        let of_bonds =
            if matches!(self.in_touch, InTouch::Bonded) { 0.5 * self.reach } else { 0.0 };
        of_bonds.max(way_of_walls.min(self.reach))
    }
}

/// Motion of a grain relative to the other body of a contact during a step, with constant acceleration. Times are
/// counted in seconds from the beginning of the step. If a shock (collision) has changed the velocity during the step,
/// this is the motion after the shock, extended back to the beginning of the step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RelativeMotion {
    /// Displacement, m, that makes the positions after a shock (collision) right, although times are counted from the
    /// beginning of the step. It points from the actual relative position at the beginning of the step to the position
    /// from which the grain would have had to start at its present velocity to be where it is now. 0 if no shock has
    /// changed the velocity during the step.
    pub offset: DVec2,
    /// Velocity of the grain minus the velocity of the other body of the contact at the beginning of the step, m/s. If
    /// a shock (collision) has changed the velocity during the step, the motion after the shock is extended back to the
    /// beginning of the step.
    pub velocity: DVec2,
    /// Acceleration of the grain relative to the other body of the contact, m/s². It is constant during the step.
    pub acceleration: DVec2,
}

impl RelativeMotion {
    /// Returns the displacement (m) of the grain relative to the other body of the contact, from the beginning of the
    /// step to the time `secs` seconds later.
    fn way(&self, secs: f64) -> DVec2 {
        self.offset + secs * (self.velocity + 0.5 * secs * self.acceleration)
    }

    /// Returns the velocity of the grain relative to the other body of the contact at the time `secs`, counted in
    /// seconds from the beginning of the step, m/s.
    pub(crate) fn velocity_at(&self, secs: f64) -> DVec2 {
        self.velocity + secs * self.acceleration
    }

    /// Returns the unit normal from the other body of a contact to its grain, and the gap between them (m), at the time
    /// `secs`, counted in seconds from the beginning of the step. `None` if the other body is a wall part, the point of
    /// it that is nearest to the grain is a corner which it shares with a second wall part, and a contact at this
    /// corner counts for the second part.
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

    /// Returns the time of impact (the first time in the interval `from` to `to`, in seconds from the beginning of the
    /// step, at which the two bodies of the contact touch and approach each other), and the unit normal at that time,
    /// from the other body to the grain. `None` if they do not meet in this interval.
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

/// Returns the first time h > 0, s, at which a gap that is now `gap` (m) becomes zero. The gap now grows at the speed
/// `speed` (m/s, negative if it closes), with the constant acceleration `acceleration` (m/s²). `None` if the gap never
/// closes.
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
