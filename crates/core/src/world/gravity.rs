//! Gravity in a scene (the acceleration field of the grains), and the rotation of its direction over time, as in a
//! tilted box.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::error::{self, Error, Result};
use crate::number::is_zero;
use crate::world::motion::{at_time, direction};
use crate::world::motion_check::check_table;
use crate::world::{Physics, World};

/// Gravity: an acceleration field for all grains, except those for which
/// [`Grain::feels_gravity`](super::Grain::feels_gravity) is false.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Gravity {
    /// Uniform gravity: the same acceleration everywhere.
    Uniform {
        /// Acceleration, m/s².
        acceleration: DVec2,
    },
    /// Attraction: an acceleration of constant magnitude towards a point (Abramian & Staron 2020, §4). It is zero at
    /// the point itself.
    Attraction {
        /// The centre of attraction, m.
        centre: DVec2,
        /// Magnitude of the acceleration, m/s².
        magnitude: f64,
    },
}

impl Gravity {
    /// Returns the acceleration by gravity at a position (m), m/s².
    pub fn acceleration(&self, position: DVec2) -> DVec2 {
        match *self {
            Self::Uniform { acceleration } => acceleration,
            Self::Attraction { centre, magnitude } => {
                magnitude * (centre - position).normalize_or_zero()
            }
        }
    }

    /// Returns the x component of the acceleration by gravity, m/s², at `x` (m) in a scene on a line (x axis only).
    pub(crate) fn acceleration_on_line(&self, x: f64) -> f64 {
        match *self {
            Self::Uniform { acceleration } => acceleration.x,
            Self::Attraction { centre, magnitude } => {
                let offset = centre.x - x;
                if offset == 0.0 { 0.0 } else { magnitude.copysign(offset) }
            }
        }
    }

    /// Returns the potential energy per mass in this gravity at a position (m), J/kg.
    pub(crate) fn potential(&self, position: DVec2) -> f64 {
        match *self {
            Self::Uniform { acceleration } => -acceleration.dot(position),
            Self::Attraction { centre, magnitude } => magnitude * position.distance(centre),
        }
    }

    /// Returns the magnitude g of the acceleration by gravity, m/s². The Bond number is the cohesion force divided by
    /// the weight of the effective mass, which is computed with this g unless the parameters give another acceleration.
    pub fn magnitude(&self) -> f64 {
        match *self {
            Self::Uniform { acceleration } => acceleration.length(),
            Self::Attraction { magnitude, .. } => magnitude,
        }
    }
}

/// Rotation of the direction of uniform gravity over time. At the angle 0 gravity has the direction that the scene
/// gives.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GravityTurn {
    /// Angle of rotation of gravity as a function of time.
    pub course: TurnCourse,
    /// Time since the rotation of gravity began, s.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub elapsed_secs: f64,
}

/// Angle of rotation of gravity as a function of time, positive anticlockwise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum TurnCourse {
    /// Rotation of gravity at constant angular velocity.
    Rate {
        /// Angular velocity of the direction of gravity, rad/s.
        rate: f64,
    },
    /// Angle of gravity from a table of times and angles, linear between its rows. The angle is constant before the
    /// first and after the last row.
    Table {
        /// Times in increasing order, s.
        times_secs: Vec<f64>,
        /// Angle at each time, rad.
        angles: Vec<f64>,
    },
}

/// Uniform gravity whose direction can change, by a rotation over time and by the parameter `tilt` of the run.
/// [`World::gravity`](super::World::gravity) is the gravity of the last step, or, if the tilt has changed since then,
/// the present gravity.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TurningGravity {
    /// Acceleration by gravity at an angle of 0, m/s², as the scene gives it.
    pub listed: DVec2,
    /// Rotation of gravity over time, which starts from the direction of `listed`.
    pub turn: GravityTurn,
    /// Angle by which the parameter `tilt` of the run turns gravity, rad, positive anticlockwise, in addition to the
    /// rotation over time. It stays constant until that parameter changes.
    pub tilt: f64,
}

impl TurningGravity {
    /// Combines uniform gravity with its rotation `turn` over time. Returns `None` without `turn`, or if `gravity` is
    /// not uniform.
    pub(crate) fn of(gravity: Gravity, turn: Option<&GravityTurn>) -> Option<Self> {
        match gravity {
            Gravity::Uniform { acceleration } => {
                turn.map(|turn| Self { listed: acceleration, turn: turn.clone(), tilt: 0.0 })
            }
            Gravity::Attraction { .. } => None,
        }
    }

    /// Returns gravity for a step that covers the next `secs` seconds. The angle is taken at the middle of the step,
    /// so the error of the impulse of one step is of order Δt³ (Δt: time step).
    pub(crate) fn in_next(&self, secs: f64) -> Gravity {
        let angle = self.turn.angle(self.turn.elapsed_secs + 0.5 * secs) + self.tilt;
        Gravity::Uniform { acceleration: direction(angle).rotate(self.listed) }
    }
}

impl GravityTurn {
    pub(super) const NONE: Self =
        Self { course: TurnCourse::Rate { rate: 0.0 }, elapsed_secs: 0.0 };

    /// Returns true if the rotation of gravity is given as a constant rate of 0. Returns false for a table of angles,
    /// also if the angles do not change.
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
    /// Turns uniform gravity by an angle (rad, positive anticlockwise), in addition to its rotation over time. The
    /// angle is measured from the direction without this turn, so a second call replaces the angle of the first.
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
            // Updates `gravity` for code that reads the state before the next step.
            self.gravity = turning.in_next(0.0);
        }
    }

    /// Returns the downward direction, as a unit vector: the direction of the gravity that the scene gives. Grains
    /// that move far away in this direction count as having left the scene. `None` if gravity rotates over time, is
    /// not uniform, or is zero.
    pub(crate) fn listed_down(&self) -> Option<DVec2> {
        let listed = match (&self.gravity_turn, self.gravity) {
            (Some(turning), _) if turning.turn.is_none() => turning.listed,
            (None, Gravity::Uniform { acceleration }) => acceleration,
            _ => return None,
        };
        Some(listed.normalize_or_zero()).filter(|&down| down != DVec2::ZERO)
    }
}
