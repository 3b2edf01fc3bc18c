//! The acceleration field of the grains, and its rotation, as in a tilted box.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::error::{self, Error, Result};
use crate::number::is_zero;
use crate::world::motion::{at_time, direction};
use crate::world::motion_check::check_table;
use crate::world::{Physics, World};

/// An acceleration field. Single grains can ignore it (`feels_gravity`).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Gravity {
    /// The same acceleration everywhere.
    Uniform {
        /// Acceleration, m/s².
        acceleration: DVec2,
    },
    /// Constant magnitude, towards a point (paper §4); zero at the point itself.
    Attraction {
        /// The centre of attraction, m.
        centre: DVec2,
        /// Magnitude, m/s².
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

    /// The x component of the acceleration in a scene with the x axis only, m/s².
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

    /// g, the magnitude that the Bond number refers to, m/s².
    pub fn magnitude(&self) -> f64 {
        match *self {
            Self::Uniform { acceleration } => acceleration.length(),
            Self::Attraction { magnitude, .. } => magnitude,
        }
    }
}

/// Rotation of uniform gravity over time, starting from its listed direction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GravityTurn {
    /// The angle over time.
    pub course: TurnCourse,
    /// Time since the rotation began, s.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub elapsed_secs: f64,
}

/// An angle over time, positive anticlockwise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum TurnCourse {
    /// Constant rate.
    Rate {
        /// Rate, rad/s.
        rate: f64,
    },
    /// Piecewise linear between the rows of a table; constant before the first and after the last.
    Table {
        /// Times in increasing order, s.
        times_secs: Vec<f64>,
        /// One angle per time, rad.
        angles: Vec<f64>,
    },
}

/// Turning gravity of a world. [`World::gravity`](super::World::gravity) is its value in the last step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TurningGravity {
    /// The acceleration at an angle of 0, m/s².
    pub listed: DVec2,
    /// The rotation from there.
    pub turn: GravityTurn,
    /// Additional tilt, constant until it is changed, rad.
    pub tilt: f64,
}

impl TurningGravity {
    /// Makes the turning gravity from `gravity` and `turn`. Only uniform gravity turns; otherwise `None`.
    pub(crate) fn of(gravity: Gravity, turn: Option<&GravityTurn>) -> Option<Self> {
        match gravity {
            Gravity::Uniform { acceleration } => {
                turn.map(|turn| Self { listed: acceleration, turn: turn.clone(), tilt: 0.0 })
            }
            Gravity::Attraction { .. } => None,
        }
    }

    /// The gravity of the next `secs`, evaluated at their middle, so that the error of a step's impulse is of order
    /// Δt³.
    pub(crate) fn in_next(&self, secs: f64) -> Gravity {
        let angle = self.turn.angle(self.turn.elapsed_secs + 0.5 * secs) + self.tilt;
        Gravity::Uniform { acceleration: direction(angle).rotate(self.listed) }
    }
}

impl GravityTurn {
    pub(super) const NONE: Self =
        Self { course: TurnCourse::Rate { rate: 0.0 }, elapsed_secs: 0.0 };

    /// True if the gravity does not turn by itself.
    pub fn is_none(&self) -> bool {
        self.course == Self::NONE.course
    }

    fn angle(&self, time: f64) -> f64 {
        match &self.course {
            TurnCourse::Rate { rate } => rate * time,
            TurnCourse::Table { times_secs, angles } => at_time(times_secs, angles, time),
        }
    }

    pub(crate) fn check(&self, gravity: &Gravity, physics: Physics) -> Result<()> {
        let field = "gravity_turn";
        if !matches!(gravity, Gravity::Uniform { .. }) {
            return Err(Error::value(field, "given", "left out where gravity is not uniform"));
        }
        error::check(physics.axes != 1, field, "given", "left out where physics.axes is 1")?;
        if !(self.elapsed_secs >= 0.0 && self.elapsed_secs.is_finite()) {
            let field = format!("{field}.elapsed_secs");
            return Err(Error::value(field, self.elapsed_secs, "a finite number ≥ 0"));
        }
        match &self.course {
            TurnCourse::Rate { rate } if !rate.is_finite() => {
                Err(Error::value(format!("{field}.course.rate"), rate, "finite"))
            }
            TurnCourse::Rate { .. } => Ok(()),
            TurnCourse::Table { times_secs, angles } => {
                let finite = angles.iter().map(|angle| angle.is_finite());
                check_table(&format!("{field}.course"), times_secs, "angles", finite)
            }
        }
    }
}

impl World {
    /// Tilts uniform gravity by an angle (rad, positive anticlockwise) relative to its listed direction and its own
    /// rotation.
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
            // Shown to anyone who looks at the state before the next step.
            self.gravity = turning.in_next(0.0);
        }
    }

    /// The direction in which grains that leave the scene are lost: that of listed gravity. `None` if gravity turns
    /// by itself or is not uniform.
    pub(crate) fn listed_down(&self) -> Option<DVec2> {
        let listed = match (&self.gravity_turn, self.gravity) {
            (Some(turning), _) if turning.turn.is_none() => turning.listed,
            (None, Gravity::Uniform { acceleration }) => acceleration,
            _ => return None,
        };
        Some(listed.normalize_or_zero()).filter(|&down| down != DVec2::ZERO)
    }
}
