//! The surface of a fixed body that moves.

use glam::DVec2;

/// How the surface of a fixed body goes where a contact touches it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surface {
    /// The velocity of the shape there, m/s.
    pub velocity: DVec2,
    /// What the surface has besides along t, round the shape that stays, m/s.
    pub round: f64,
    /// Whether the shape is a half-space, which looks the same wherever it goes along itself.
    pub is_half_space: bool,
    /// Whether the shape goes along its normal and no other way.
    pub is_pushed: bool,
}

impl Surface {
    /// How fast it goes along n and t, m/s.
    #[inline]
    pub(crate) fn along(&self, normal: DVec2) -> [f64; 2] {
        let tangential = if self.is_pushed { 0.0 } else { self.velocity.dot(normal.perp()) };
        [self.velocity.dot(normal), tangential + self.round]
    }
}
