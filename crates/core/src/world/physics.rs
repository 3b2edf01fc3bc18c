//! The effects that the mechanics of a scene includes: the number of axes, friction, rotation and cohesion.

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};

/// The effects that the mechanics of a scene includes: axes, friction, rotation and cohesion. The code of a step is
/// compiled separately for each combination.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Physics {
    /// Number of axes: 1 (all centres are on the x axis, and bodies move only along it) or 2.
    pub axes: u8,
    /// True if contacts transmit tangential impulses.
    pub friction: bool,
    /// True if grains rotate. Requires friction, because without friction nothing changes the angular velocity of a
    /// disc.
    pub rotation: bool,
    /// True if contacts can pull (cohesion).
    pub cohesion: bool,
}

impl Physics {
    /// Mechanics with two axes, friction, rotation and cohesion.
    pub const FULL: Self = Self { axes: 2, friction: true, rotation: true, cohesion: true };

    pub(crate) fn validate(&self) -> Result<()> {
        match (self.axes, self.friction, self.rotation) {
            (1 | 2, false, true) => {
                Err(Error::value("physics.rotation", true, "false where physics.friction is false"))
            }
            (1, true, _) => Err(Error::value(
                "physics.friction",
                true,
                "false where physics.axes is 1: a line has no tangent",
            )),
            (1 | 2, ..) => Ok(()),
            (axes, ..) => Err(Error::value("physics.axes", axes, "1 or 2")),
        }
    }
}
