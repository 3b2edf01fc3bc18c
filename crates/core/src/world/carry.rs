//! Rigid motion in the plane: the velocity of a body that moves, and where it is carried.

use glam::DVec2;

/// How a body goes during a step: straight on, or round a pivot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RigidVelocity {
    /// m/s; none of a body that turns.
    pub velocity: DVec2,
    /// rad/s, positive anticlockwise.
    pub spin: f64,
    /// m.
    pub pivot: DVec2,
}

/// A way of a rigid body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Carry {
    /// m; none of a body that turns.
    pub by: DVec2,
    /// rad.
    pub angle: f64,
    pivot: DVec2,
    /// (cos, sin) of the angle.
    turn: DVec2,
}

impl RigidVelocity {
    /// That of a body which stays.
    pub(crate) const NONE: Self = Self { velocity: DVec2::ZERO, spin: 0.0, pivot: DVec2::ZERO };

    pub(super) fn straight(velocity: DVec2) -> Self {
        Self { velocity, ..Self::NONE }
    }

    pub(super) fn round(pivot: DVec2, spin: f64) -> Self {
        Self { spin, pivot, ..Self::NONE }
    }

    /// The velocity of a point of the body, m/s.
    #[inline]
    pub(crate) fn at(&self, place: DVec2) -> DVec2 {
        if self.spin == 0.0 { self.velocity } else { self.spin * (place - self.pivot).perp() }
    }

    /// Whether the body does not stay.
    pub(crate) fn moves(&self) -> bool {
        self.velocity != DVec2::ZERO || self.spin != 0.0
    }

    /// The way in `secs`.
    pub(crate) fn carry(&self, secs: f64) -> Carry {
        let angle = secs * self.spin;
        let (sin, cos) = angle.sin_cos();
        Carry { by: secs * self.velocity, angle, pivot: self.pivot, turn: DVec2::new(cos, sin) }
    }
}

impl Carry {
    /// Where it brings a point of the body.
    pub(crate) fn place(&self, place: DVec2) -> DVec2 {
        if self.angle == 0.0 {
            place + self.by
        } else {
            self.pivot + self.turned(place - self.pivot)
        }
    }

    /// What it makes of a direction.
    pub(crate) fn turned(&self, direction: DVec2) -> DVec2 {
        if self.angle == 0.0 { direction } else { self.turn.rotate(direction) }
    }

    /// How far it brings any point at most that is no farther than `reach` from the pivot, m.
    pub(crate) fn longest_way(&self, reach: f64) -> f64 {
        self.by.length() + self.angle.abs() * reach
    }

    /// Whether it brings anything anywhere.
    pub(crate) fn goes(&self) -> bool {
        self.by != DVec2::ZERO || self.angle != 0.0
    }

    /// The pivot, m.
    pub(crate) fn pivot(&self) -> DVec2 {
        self.pivot
    }
}
