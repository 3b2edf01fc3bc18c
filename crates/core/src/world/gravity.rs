//! The field that accelerates the grains.

use glam::DVec2;
use serde::{Deserialize, Serialize};

/// An acceleration field. Each grain can be told to ignore it (`feels_gravity`).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Gravity {
    /// The same everywhere.
    Uniform {
        /// m/s².
        acceleration: DVec2,
    },
    /// Of the same norm everywhere, towards a point (paper §4); zero at the point itself.
    Attraction {
        /// The centre of attraction, m.
        centre: DVec2,
        /// m/s².
        magnitude: f64,
    },
}

impl Gravity {
    /// The acceleration at a position, m/s².
    pub fn acceleration(&self, position: DVec2) -> DVec2 {
        match *self {
            Self::Uniform { acceleration } => acceleration,
            Self::Attraction { centre, magnitude } => {
                magnitude * (centre - position).normalize_or_zero()
            }
        }
    }

    /// The x component of the acceleration on a scene with the x axis alone, m/s².
    pub(crate) fn acceleration_on_line(&self, x: f64) -> f64 {
        match *self {
            Self::Uniform { acceleration } => acceleration.x,
            Self::Attraction { centre, magnitude } => {
                let offset = centre.x - x;
                if offset == 0.0 { 0.0 } else { magnitude.copysign(offset) }
            }
        }
    }

    /// Potential energy per mass at a position, J/kg.
    pub(crate) fn potential(&self, position: DVec2) -> f64 {
        match *self {
            Self::Uniform { acceleration } => -acceleration.dot(position),
            Self::Attraction { centre, magnitude } => magnitude * position.distance(centre),
        }
    }

    /// g, the norm that the Bond number refers to, m/s².
    pub fn magnitude(&self) -> f64 {
        match *self {
            Self::Uniform { acceleration } => acceleration.length(),
            Self::Attraction { magnitude, .. } => magnitude,
        }
    }
}
