//! Gap and normal between two bodies, and the time at which two freely moving bodies meet.
//!
//! **Time of impact.** A body is convex, so its distance is a convex function along a straight path: the tangent of
//! the gap never exceeds the gap, and Newton's iteration approaches its first zero from below without passing it.
//! With an acceleration, the parabola of gap, speed and acceleration replaces the tangent. If the gap stops closing,
//! the two bodies pass each other; the tangent at the beginning alone cannot show that.

use glam::DVec2;

use super::candidates::Candidates;
use super::numbering::{Numbering, Other};
use super::pair::Contact;
use crate::number::Parts;
use crate::world::World;

/// Limit for Newton's iterations to a meeting. They converge quadratically, but only by halving at first if the two
/// bodies graze each other.
const MOST_STEPS: u32 = 60;
/// Gap that counts as zero because of rounding, in radii.
const ROUNDING_IN_RADII: f64 = 1e-13;

/// Normal and gap (m) between a disc (centre, radius; m) and another body. `None` if another feature reports the
/// nearest point.
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

/// Normal (from j to i) and gap of two discs, with i at `offset` from j. Coincident centres get a normal along x, so
/// that the step stays finite.
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
    /// The present gap of the pair, m. `None` if the grain now touches another feature instead.
    pub(crate) fn gap_now(&self, world: &World, near: &Candidates, axes: usize) -> Option<f64> {
        let (grain, other) = (self.grain as usize, Numbering::of(world).other(self.other));
        let (position, radius) = (world.grains.positions[grain], world.grains.radii[grain]);
        approach(world, near, position, radius, other, axes).map(|(_, gap)| gap)
    }
}

/// Selects pairs with a gap that are contacts too, because they may touch within the step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LookAhead {
    /// Δt, s.
    pub time_step_secs: f64,
    /// Pairs that would approach to less than this distance are contacts, m.
    pub distance: f64,
    /// Pairs farther apart than this are not contacts, m.
    pub reach: f64,
    /// Which of the contacts are in touch.
    pub in_touch: InTouch,
}

/// Criterion by which a contact is in touch and can pull. Other contacts are only near.
#[derive(Clone, Copy, Debug)]
pub(crate) enum InTouch {
    /// Pairs that touch as the step begins.
    Touching,
    /// Pairs that have touched. They stay bonded, and contacts, until the bond breaks.
    Bonded,
    /// Pairs with at most this gap as the step begins, m.
    Within(f64),
}

impl LookAhead {
    /// The same look-ahead, with all pairs up to `range` (m) apart in touch.
    pub(crate) fn pulling_within(self, range: f64) -> Self {
        Self {
            distance: self.distance.max(range),
            reach: self.reach.max(range),
            in_touch: InTouch::Within(range),
            ..self
        }
    }

    /// The gap that a grain of this velocity (m/s) may close by its own speed, m. Bonds may be open however slow
    /// their grains are, so with bonds it is half the reach.
    pub(crate) fn way_of_grain(&self, velocity: DVec2) -> f64 {
        /// Allowance for the rounding of a speed.
        const ROUNDING: f64 = 1.0 + 1e-9;
        match self.in_touch {
            InTouch::Bonded => 0.5 * self.reach,
            InTouch::Touching | InTouch::Within(_) => {
                let own = self.time_step_secs * velocity.length() + self.distance;
                ROUNDING * own.min(self.reach)
            }
        }
    }

    /// Detection distance for walls and fixed discs, m, if the fastest wall moves by `way_of_walls` in the step.
    pub(crate) fn way_of_others(&self, way_of_walls: f64) -> f64 {
        let of_bonds =
            if matches!(self.in_touch, InTouch::Bonded) { 0.5 * self.reach } else { 0.0 };
        of_bonds.max(way_of_walls.min(self.reach))
    }
}

/// Motion of a grain relative to the other body of a contact during a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RelativeMotion {
    /// Offset of the starting point from the present relative position, m.
    pub offset: DVec2,
    /// v, m/s.
    pub velocity: DVec2,
    /// a, m/s².
    pub acceleration: DVec2,
}

impl RelativeMotion {
    /// Relative displacement x(s) − x, m.
    fn way(&self, secs: f64) -> DVec2 {
        self.offset + secs * (self.velocity + 0.5 * secs * self.acceleration)
    }

    /// Relative velocity at s, m/s.
    pub(crate) fn velocity_at(&self, secs: f64) -> DVec2 {
        self.velocity + secs * self.acceleration
    }

    /// Normal and gap at s. `None` if another feature reports the nearest point.
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

    /// Time of impact: the first time in the given interval (s) at which the two bodies touch, and their normal then.
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

/// The first h > 0, s, at which a gap (m) with opening speed (m/s) and acceleration (m/s²) is zero.
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
        // ½·2·h² − 3h + 2 is zero at h = 1, and again at h = 2.
        assert_eq!(first_zero(2.0, -3.0, 2.0), Some(1.0));
        assert_eq!(first_zero(2.0, -1.0, 2.0), None);
        let h = first_zero(2.0, 1.0, -2.0).expect("it falls back");
        assert!((2.0 + h - h * h).abs() < 1e-15);
    }
}
