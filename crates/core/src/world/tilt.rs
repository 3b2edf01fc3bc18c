//! Gravity that is tilted by hand.

use glam::DVec2;

use super::gravity_turn::{GravityTurn, TurningGravity};
use super::{Gravity, World};

impl World {
    /// Tilts uniform gravity by an angle (rad, positive anticlockwise) against how it is listed and turns by itself.
    pub(crate) fn tilt(&mut self, angle: f64) {
        if angle != 0.0
            && self.gravity_turn.is_none()
            && let Gravity::Uniform { acceleration: listed } = self.gravity
        {
            self.gravity_turn = Some(TurningGravity { listed, turn: GravityTurn::NONE, tilt: 0.0 });
        }
        if let Some(turning) = &mut self.gravity_turn
            && turning.tilt != angle
        {
            turning.tilt = angle;
            // What is looked at before the next step shows it.
            self.gravity = turning.in_next(0.0);
        }
    }

    /// The direction in which grains that leave are lost, where there is one throughout: that of gravity as it is
    /// listed. What turns by itself has none.
    pub(crate) fn listed_down(&self) -> Option<DVec2> {
        let listed = match (&self.gravity_turn, self.gravity) {
            (Some(turning), _) if turning.turn.is_none() => turning.listed,
            (None, Gravity::Uniform { acceleration }) => acceleration,
            _ => return None,
        };
        Some(listed.normalize_or_zero()).filter(|&down| down != DVec2::ZERO)
    }
}
