//! The surface of a fixed body that moves.

use glam::DVec2;

use super::driven::DrivenBy;

/// How the surface of a fixed body goes where a contact touches it.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// The velocity of the shape there, m/s.
    pub velocity: DVec2,
    /// What the surface has besides along t, round the shape that stays, m/s.
    pub round: f64,
    /// Whether the shape is a half-space, which looks the same wherever it goes along itself.
    pub is_half_space: bool,
    /// Whether the shape goes along its normal and no other way.
    pub is_pushed: bool,
    /// What drives the shape, if a force does.
    pub driven: Option<DrivenBy>,
}

impl Surface {
    /// The same where nothing rubs.
    pub(super) fn smooth(self) -> Self {
        let smooth = |by: DrivenBy| DrivenBy { along: [by.along[0], 0.0], ..by };
        Self { is_pushed: true, round: 0.0, driven: self.driven.map(smooth), ..self }
    }

    /// How fast it goes along n and t, m/s.
    #[inline]
    pub(crate) fn along(&self, normal: DVec2) -> [f64; 2] {
        let tangential = if self.is_pushed { 0.0 } else { self.velocity.dot(normal.perp()) };
        [self.velocity.dot(normal), tangential + self.round]
    }
}
