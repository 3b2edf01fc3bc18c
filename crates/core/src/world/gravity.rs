//! The field that accelerates the grains, and how it turns, as a box that is tilted feels it.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::error::{self, Error, Result};
use crate::number::is_zero;
use crate::world::motion::{at_time, direction};
use crate::world::motion_check::check_table;
use crate::world::{Physics, World};

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

/// How uniform gravity turns over time, from the direction in which it is listed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GravityTurn {
    /// By which angle.
    pub course: TurnCourse,
    /// How long it has been turning, s.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub elapsed_secs: f64,
}

/// An angle over time, positive anticlockwise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum TurnCourse {
    /// Evenly.
    Rate {
        /// rad/s.
        rate: f64,
    },
    /// Through angles at times, evenly from one to the next; before the first and after the last it stays.
    Table {
        /// Rising, s.
        times_secs: Vec<f64>,
        /// One a time, rad.
        angles: Vec<f64>,
    },
}

/// Gravity of a world that turns: [`World::gravity`](super::World::gravity) is what it is in the last step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TurningGravity {
    /// The acceleration at an angle of 0, m/s².
    pub listed: DVec2,
    /// How it turns from there.
    pub turn: GravityTurn,
    /// By which angle it is turned besides, as long as it is not changed, rad.
    pub tilt: f64,
}

impl TurningGravity {
    /// That of a gravity, which is uniform where it turns.
    pub(crate) fn of(gravity: Gravity, turn: Option<&GravityTurn>) -> Option<Self> {
        match gravity {
            Gravity::Uniform { acceleration } => {
                turn.map(|turn| Self { listed: acceleration, turn: turn.clone(), tilt: 0.0 })
            }
            Gravity::Attraction { .. } => None,
        }
    }

    /// The gravity of the next `secs`: that of the middle of them, so that a step's impulse of it errs by Δt³.
    pub(crate) fn in_next(&self, secs: f64) -> Gravity {
        let angle = self.turn.angle(self.turn.elapsed_secs + 0.5 * secs) + self.tilt;
        Gravity::Uniform { acceleration: direction(angle).rotate(self.listed) }
    }
}

impl GravityTurn {
    pub(super) const NONE: Self =
        Self { course: TurnCourse::Rate { rate: 0.0 }, elapsed_secs: 0.0 };

    /// True where it turns nothing.
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
