//! What a scene can do.

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};

/// The physics that a scene needs. A step is compiled for just that.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Physics {
    /// 1 (all on the x axis) or 2.
    pub axes: u8,
    /// Whether contacts carry tangential impulses.
    pub friction: bool,
    /// Whether grains turn. Without friction nothing changes a disc's spin, so this asks for
    /// friction.
    pub rotation: bool,
    /// Whether contacts can pull.
    pub cohesion: bool,
}

impl Physics {
    /// Two axes, friction, rotation and cohesion.
    pub const FULL: Self = Self { axes: 2, friction: true, rotation: true, cohesion: true };

    /// Checks that the parts fit each other.
    ///
    /// # Errors
    /// Names the field that does not fit.
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
