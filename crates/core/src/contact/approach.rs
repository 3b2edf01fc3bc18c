//! How far two bodies are from each other, along which normal, and when they meet that nothing holds.
//!
//! **When the gap closes.** A body is convex, and so is the distance to it along a straight way: the tangent
//! of the gap is never above it, and Newton's steps come to its first zero from below without passing it.
//! With an acceleration the parabola of gap, speed and acceleration takes the tangent's place. Where the
//! gap no longer closes the two pass by each other, which the tangent at the beginning alone cannot tell.

use glam::DVec2;

use super::candidates::Candidates;
use super::contact::Contact;
use super::numbering::{Numbering, Other};
use crate::number::Parts;
use crate::world::World;

/// Newton's steps to a meeting at the most. They converge quadratically, but where two bodies graze each
/// other by halves at first.
const MOST_STEPS: u32 = 60;
/// A gap that is none but for rounding, in radii.
const ROUNDING_IN_RADII: f64 = 1e-13;

/// Normal and gap between a disc (centre, radius; m) and another body, or nothing where another feature tells of the
/// touched point.
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

/// Normal (from j to i) and gap of two discs, i being off j by `offset`. Centres that coincide are told apart along x, so that
/// the step stays finite.
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
    /// The gap of the pair where its bodies are now, m, or nothing where another feature touches the grain instead.
    pub(crate) fn gap_now(&self, world: &World, near: &Candidates, axes: usize) -> Option<f64> {
        let (grain, other) = (self.grain as usize, Numbering::of(world).other(self.other));
        let (position, radius) = (world.grains.positions[grain], world.grains.radii[grain]);
        approach(world, near, position, radius, other, axes).map(|(_, gap)| gap)
    }
}

/// Which pairs with a gap are contacts too, because they may touch within the step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LookAhead {
    /// Δt, s.
    pub time_step_secs: f64,
    /// Pairs that would come nearer than this by themselves are contacts, m.
    pub distance: f64,
    /// Farther pairs are none, m.
    pub reach: f64,
    /// Which of the contacts are in touch.
    pub in_touch: InTouch,
}

/// Which pairs are in touch and pull, others just come near.
#[derive(Clone, Copy, Debug)]
pub(crate) enum InTouch {
    /// Those that touch as the step begins.
    Touching,
    /// Those that have touched: they are bonded from then on, and contacts until the bond breaks.
    Bonded,
    /// Those whose gap is no larger as the step begins, m.
    Within(f64),
}

impl LookAhead {
    /// The same, with all that is no farther apart than `range` (m) in touch.
    pub(crate) fn pulling_within(self, range: f64) -> Self {
        Self {
            distance: self.distance.max(range),
            reach: self.reach.max(range),
            in_touch: InTouch::Within(range),
            ..self
        }
    }

    /// The gap that a grain of that velocity (m/s) may close, m: with its own speed, but for bonds, which
    /// may be open however slow their grains are.
    pub(crate) fn way_of_grain(&self, velocity: DVec2) -> f64 {
        /// What rounding makes of a speed.
        const ROUNDING: f64 = 1.0 + 1e-9;
        match self.in_touch {
            InTouch::Bonded => 0.5 * self.reach,
            InTouch::Touching | InTouch::Within(_) => {
                let own = self.time_step_secs * velocity.length() + self.distance;
                ROUNDING * own.min(self.reach)
            }
        }
    }

    /// The gap that what is no grain is to be seen at besides, m, where the fastest wall goes `way_of_walls` in the step.
    pub(crate) fn way_of_others(&self, way_of_walls: f64) -> f64 {
        let of_bonds =
            if matches!(self.in_touch, InTouch::Bonded) { 0.5 * self.reach } else { 0.0 };
        of_bonds.max(way_of_walls.min(self.reach))
    }
}

/// How a grain goes relative to the other body of a contact, from the beginning of a step on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RelativeMotion {
    /// Where it would have begun to be where it is now, m off its place.
    pub offset: DVec2,
    /// v, m/s.
    pub velocity: DVec2,
    /// a, m/s².
    pub acceleration: DVec2,
}

impl RelativeMotion {
    /// x(s) − x, m.
    fn way(&self, secs: f64) -> DVec2 {
        self.offset + secs * (self.velocity + 0.5 * secs * self.acceleration)
    }

    /// The velocity at s, m/s.
    pub(crate) fn velocity_at(&self, secs: f64) -> DVec2 {
        self.velocity + secs * self.acceleration
    }

    /// Normal and gap at s, or nothing where another feature tells of the touched point.
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

    /// The time of impact: the first moment from one to another (s) at which the two touch, and their normal then.
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
