//! Bodies that a force moves along one axis, as a piston under a given pressure goes: a mass with one degree of freedom.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::Periodic;
use crate::error::{Error, Result};

/// What drives the bodies of a motion along an axis, and what they have against it. Weight is no part of it.
///
/// Its state is in itself: `speed` is that of the end of the last step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drive {
    /// Along which vector; its length means nothing.
    pub direction: DVec2,
    /// N along it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force: Option<f64>,
    /// In place of a force: N along it for each m of `width`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pressure: Option<f64>,
    /// What the pressure acts on, m; the period across it where borders are periodic, unless it is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub width: Option<f64>,
    /// Of all bodies of the motion together, kg.
    pub mass: f64,
    /// Force against the speed, kg/s.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub damping: f64,
    /// m/s along the direction.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub speed: f64,
}

/// What files leave out.
pub(super) fn is_zero(number: &f64) -> bool {
    *number == 0.0
}

impl Drive {
    /// The direction, of length 1.
    pub fn axis(&self) -> DVec2 {
        self.direction.normalize_or_zero()
    }

    /// The force along the axis, N.
    pub fn force_in(&self, periodic: Option<Periodic>) -> f64 {
        let width = self.width.or_else(|| self.period_across(periodic));
        self.force.unwrap_or_else(|| self.pressure.unwrap_or(0.0) * width.unwrap_or(0.0))
    }

    /// The period along the one axis, m, where borders wrap along that and the direction is along the other.
    fn period_across(&self, periodic: Option<Periodic>) -> Option<f64> {
        let [width, height] = periodic?.periods();
        let DVec2 { x, y } = self.direction;
        if x == 0.0 {
            width
        } else if y == 0.0 {
            height
        } else {
            None
        }
    }

    /// ½mv², J.
    pub fn kinetic_energy(&self) -> f64 {
        0.5 * self.mass * self.speed * self.speed
    }

    /// Checks its numbers; `field` is what users call it.
    ///
    /// # Errors
    /// Names the first number that does not fit.
    pub(super) fn check(&self, field: &str, periodic: Option<Periodic>) -> Result<()> {
        let refuse = |name: &str, found: String, allowed: &str| {
            Err(Error::value(format!("{field}.{name}"), found, allowed))
        };
        let Self { direction, force, pressure, width, mass, damping, speed } = self;
        if !(direction.is_finite() && direction.length() > 0.0) {
            return refuse("direction", direction.to_string(), "finite, and not 0");
        }
        if !(*mass > 0.0 && mass.is_finite()) {
            return refuse("mass", mass.to_string(), "a finite number of kg > 0");
        }
        if !(*damping >= 0.0 && damping.is_finite()) {
            return refuse("damping", damping.to_string(), "a finite number of kg/s ≥ 0");
        }
        if !speed.is_finite() {
            return refuse("speed", speed.to_string(), "finite");
        }
        match (force, pressure) {
            (Some(force), None) if !force.is_finite() => {
                refuse("force", force.to_string(), "a finite number of N")
            }
            (None, Some(pressure)) if !pressure.is_finite() => {
                refuse("pressure", pressure.to_string(), "a finite number of N/m")
            }
            (Some(_), None) if width.is_some() => {
                refuse("width", "given".into(), "left out where no pressure is given")
            }
            (Some(_), None) => Ok(()),
            (None, Some(_)) => match width {
                Some(width) if !(*width > 0.0 && width.is_finite()) => {
                    refuse("width", width.to_string(), "a finite number of m > 0")
                }
                None if self.period_across(periodic).is_none() => refuse(
                    "width",
                    "left out".into(),
                    "given with a pressure, unless borders are periodic and it acts across their axis",
                ),
                _ => Ok(()),
            },
            (Some(_), Some(_)) | (None, None) => {
                let found = if force.is_some() { "given with a pressure" } else { "left out" };
                refuse("force", found.into(), "given, or else a pressure, and not both")
            }
        }
    }
}
