//! Prescribed and force-driven motion of fixed discs and boundaries, and speeds of surfaces that move along
//! themselves, as of a conveyor belt. Contact forces of grains act only on bodies that a force drives, not on
//! prescribed motions.

use std::f64::consts::TAU;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::number::Parts;
use crate::number::is_zero;
use crate::world::Periodic;

/// A motion of some boundaries and fixed discs, which move together as one rigid body.
///
/// The motion stores its own progress: as the bodies move, `elapsed_secs` grows and the remaining `travel` of the
/// prescribed motion (`course`) shrinks.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Motion {
    /// Indices of the boundaries that have this motion, counted from 0.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub boundaries: Vec<usize>,
    /// Indices of the fixed discs that have this motion, counted from 0.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub fixed_discs: Vec<usize>,
    /// Prescribed position of the bodies over time (course). If it is missing, only the force or pressure of `drive`,
    /// if there is one, moves the bodies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub course: Option<MotionCourse>,
    /// Force or pressure that moves the bodies, in addition to their prescribed motion.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drive: Option<Drive>,
    /// Speed of the surface along itself, m/s, as of a conveyor belt. It does not move the shape. A positive speed is
    /// along the outward normal turned by +90°, which is anticlockwise around a disc or a polygon.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub surface_speed: f64,
    /// Time since the motion began, s.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub elapsed_secs: f64,
    /// Angle by which the bodies have rotated since the motion began, rad, positive anticlockwise.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub turned: f64,
}

/// Prescribed displacement or rotation of bodies over time, relative to the positions that the scene gives.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum MotionCourse {
    /// Straight line at constant speed.
    Straight {
        /// Direction of the motion. Its length does not matter.
        direction: DVec2,
        /// Speed along the given direction, m/s.
        speed: f64,
        /// Remaining distance until the motion stops, m. The motion does not stop if this is missing.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        travel: Option<f64>,
    },
    /// Rotation about a pivot at constant angular velocity.
    Rotation {
        /// Position of the pivot, m.
        pivot: DVec2,
        /// Angular velocity, rad/s, positive anticlockwise.
        rate: f64,
        /// Remaining angle until the rotation stops, rad. The rotation does not stop if this is missing.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        travel: Option<f64>,
    },
    /// Oscillation along a line. The displacement (m) at the time t (s) is amplitude · (sin(2π·frequency·t + phase) −
    /// sin(phase)), with the amplitude in m as a vector along the line, the frequency in Hz and the phase in rad.
    Sine {
        /// Amplitude, m.
        amplitude: DVec2,
        /// Frequency, Hz.
        frequency_hz: f64,
        /// Phase, rad.
        #[serde(default, skip_serializing_if = "is_zero")]
        phase: f64,
    },
    /// Oscillation about a pivot. The angle (rad) at the time t (s) is amplitude · (sin(2π·frequency·t + phase) −
    /// sin(phase)), with the amplitude in rad, the frequency in Hz and the phase in rad.
    Swing {
        /// Position of the pivot, m.
        pivot: DVec2,
        /// Amplitude, rad.
        amplitude: f64,
        /// Frequency, Hz.
        frequency_hz: f64,
        /// Phase, rad.
        #[serde(default, skip_serializing_if = "is_zero")]
        phase: f64,
    },
    /// Displacement from a table of times and displacements, linear between its rows. The displacement is constant
    /// before the first and after the last row.
    Table {
        /// Times in increasing order, s.
        times_secs: Vec<f64>,
        /// Displacement at each time, m. Only the differences between displacements matter.
        offsets: Vec<DVec2>,
    },
    /// Rotation about a pivot, with angles from a table of times and angles, linear between its rows.
    AngleTable {
        /// Position of the pivot, m.
        pivot: DVec2,
        /// Times in increasing order, s.
        times_secs: Vec<f64>,
        /// Angle at each time, rad. Only the differences between angles matter.
        angles: Vec<f64>,
    },
}

impl Motion {
    /// Returns the mean velocity of the bodies that the course (their prescribed motion) gives for the next `secs`
    /// seconds.
    pub(crate) fn velocity_in(&self, secs: f64) -> RigidVelocity {
        let course = self.course.as_ref();
        course.map_or(RigidVelocity::NONE, |course| course.velocity_in(self.elapsed_secs, secs))
    }

    /// Returns the velocity that the bodies have just before a step of `secs` seconds. If their course (prescribed
    /// motion) is an oscillation along a line (sine) or about a pivot (swing), which is smooth, this is the mean
    /// velocity over the `secs` seconds before the step. Under other courses the velocity changes only by jumps, and
    /// after a jump the wall must strike the grains with its new velocity. So for these courses the mean velocity
    /// during the step is returned.
    pub(crate) fn velocity_before(&self, secs: f64) -> RigidVelocity {
        match &self.course {
            Some(course @ (MotionCourse::Sine { .. } | MotionCourse::Swing { .. })) => {
                course.velocity_in(self.elapsed_secs - secs, secs)
            }
            _ => self.velocity_in(secs),
        }
    }

    /// Returns a vector of any length along which the bodies move in a step with the velocity `velocity`. `None` if
    /// they do not move along a line.
    pub(crate) fn direction(&self, velocity: &RigidVelocity) -> Option<DVec2> {
        match (&self.course, &self.drive) {
            (None, Some(drive)) => Some(drive.direction),
            (Some(MotionCourse::Straight { direction, .. }), None) => Some(*direction),
            (Some(MotionCourse::Sine { amplitude, .. }), None) => Some(*amplitude),
            // The course moves the bodies across the force of the drive, so their surface rubs against grains even
            // while the force does not move it.
            (Some(_), Some(_)) => None,
            _ => (velocity.spin == 0.0).then_some(velocity.velocity),
        }
    }

    /// True if the prescribed course rotates the bodies about a pivot.
    pub(super) fn turns(&self) -> bool {
        self.course.as_ref().is_some_and(|course| course.pivot().is_some())
    }

    /// True if a prescribed translation, or a drive (a force or pressure that moves the bodies), acts in a direction
    /// with a component along an axis. The index of the axis is 0 for x and 1 for y.
    pub(super) fn goes_along(&self, axis: usize) -> bool {
        self.drive.as_ref().is_some_and(|drive| drive.direction[axis] != 0.0)
            || match &self.course {
                Some(MotionCourse::Straight { direction: along, .. })
                | Some(MotionCourse::Sine { amplitude: along, .. }) => along[axis] != 0.0,
                Some(MotionCourse::Table { offsets, .. }) => {
                    offsets.iter().any(|offset| offset[axis] != offsets[0][axis])
                }
                _ => false,
            }
    }

    /// Updates the stored progress of the motion (time, angle and remaining travel) after `secs` seconds, in which the
    /// bodies moved by the displacement `carry`.
    pub(crate) fn advance(&mut self, secs: f64, carry: &Carry) {
        self.elapsed_secs += secs;
        self.turned += carry.angle;
        let (left, gone) = match &mut self.course {
            Some(MotionCourse::Straight { travel: Some(travel), .. }) => {
                (travel, carry.by.length())
            }
            Some(MotionCourse::Rotation { travel: Some(travel), .. }) => {
                (travel, carry.angle.abs())
            }
            _ => return,
        };
        *left = (*left - gone).positive_part();
    }
}

impl MotionCourse {
    /// Returns the pivot of a course (prescribed motion) that rotates the bodies, m. `None` for other courses.
    pub(super) fn pivot(&self) -> Option<DVec2> {
        match self {
            Self::Rotation { pivot, .. }
            | Self::Swing { pivot, .. }
            | Self::AngleTable { pivot, .. } => Some(*pivot),
            Self::Straight { .. } | Self::Sine { .. } | Self::Table { .. } => None,
        }
    }

    /// Returns the mean velocity of the bodies during the `secs` seconds that follow the time `elapsed` (s, since the
    /// motion began).
    fn velocity_in(&self, elapsed: f64, secs: f64) -> RigidVelocity {
        let times = [elapsed, elapsed + secs];
        match self {
            Self::Straight { direction, speed, travel } => {
                let speed = within(*speed, *travel, secs);
                RigidVelocity::straight(speed * direction.normalize_or_zero())
            }
            Self::Rotation { pivot, rate, travel } => {
                RigidVelocity::round(*pivot, within(*rate, *travel, secs))
            }
            Self::Sine { amplitude, frequency_hz, phase } => {
                RigidVelocity::straight(sine_rate(*frequency_hz, *phase, times, secs) * *amplitude)
            }
            Self::Swing { pivot, amplitude, frequency_hz, phase } => {
                let rate = sine_rate(*frequency_hz, *phase, times, secs);
                RigidVelocity::round(*pivot, rate * amplitude)
            }
            Self::Table { times_secs, offsets } => {
                let [from, to] = times.map(|time| at_time(times_secs, offsets, time));
                RigidVelocity::straight((to - from) / secs)
            }
            Self::AngleTable { pivot, times_secs, angles } => {
                let [from, to] = times.map(|time| at_time(times_secs, angles, time));
                RigidVelocity::round(*pivot, (to - from) / secs)
            }
        }
    }
}

/// Returns the speed `speed`, reduced if necessary so that in `secs` seconds the body moves at most by the remaining
/// travel `left`. The travel is in m for a speed in m/s, and in rad for a speed in rad/s.
pub(super) fn within(speed: f64, left: Option<f64>, secs: f64) -> f64 {
    left.map_or(speed, |left| speed.signum() * speed.abs().min(left / secs))
}

/// Returns the unit vector at an angle (rad) from the x axis, with the same bits on every machine.
pub(crate) fn direction(angle: f64) -> DVec2 {
    let (sin, cos) = libm::sincos(angle);
    DVec2::new(cos, sin)
}

/// Returns the mean rate of change of sin(2πft + φ) between two times, 1/s, with the frequency f (Hz) and the phase φ
/// (rad). The two times (s) are `secs` apart.
fn sine_rate(frequency_hz: f64, phase: f64, times: [f64; 2], secs: f64) -> f64 {
    let [from, to] = times.map(|time| libm::sin(TAU * frequency_hz * time + phase));
    (to - from) / secs
}

/// Returns the value of a table at a time (s): linear between the rows, constant before the first and after the last
/// row. `times_secs` increases, and the table has at least one row.
pub(super) fn at_time<T>(times_secs: &[f64], values: &[T], time: f64) -> T
where
    T: Copy + std::ops::Add<Output = T> + std::ops::Sub<Output = T>,
    f64: std::ops::Mul<T, Output = T>,
{
    let next = times_secs.partition_point(|&row| row <= time);
    let (Some(before), true) = (next.checked_sub(1), next < times_secs.len()) else {
        return values[next.min(values.len() - 1)];
    };
    let part = (time - times_secs[before]) / (times_secs[next] - times_secs[before]);
    values[before] + part * (values[next] - values[before])
}

/// A drive: a force or pressure that moves the bodies of a motion along a line, with the mass and damping of these
/// bodies. Gravity does not act on them.
///
/// The drive stores its own state: `speed` is the speed at the end of the last step.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drive {
    /// Direction in which the force acts. Its length does not matter.
    pub direction: DVec2,
    /// Force on the bodies along the direction of the drive, N.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force: Option<f64>,
    /// Pressure on the bodies, N/m: force along the direction of the drive per metre of `width`. An alternative to
    /// `force`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pressure: Option<f64>,
    /// Width on which the pressure acts, m. Default: the size of the periodic cell perpendicular to the direction of
    /// the drive.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub width: Option<f64>,
    /// Total mass of the bodies that this drive moves, kg.
    pub mass: f64,
    /// Damping coefficient of the bodies that the force drives, kg/s: the force that opposes their motion, divided by
    /// their speed.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub damping: f64,
    /// Speed of the bodies that the force drives along the direction of the drive, m/s.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub speed: f64,
}

impl Drive {
    /// Returns the direction of the drive as a unit vector.
    pub fn axis(&self) -> DVec2 {
        self.direction.normalize_or_zero()
    }

    /// Returns the force of the drive along its direction, N. If a pressure is given without a `width`, the force
    /// depends on the size of the periodic cell.
    pub fn force_in(&self, periodic: Option<Periodic>) -> f64 {
        let width = self.width.or_else(|| self.period_across(periodic));
        self.force.unwrap_or_else(|| self.pressure.unwrap_or(0.0) * width.unwrap_or(0.0))
    }

    /// Returns the size of the periodic cell perpendicular to the direction of the drive, m. `None` if the drive is not
    /// along the x or y axis, or if the cell has no periodic borders along the other axis.
    pub(super) fn period_across(&self, periodic: Option<Periodic>) -> Option<f64> {
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

    /// Kinetic energy ½mv² of the bodies that the force drives, J (m: mass, v: speed).
    pub fn kinetic_energy(&self) -> f64 {
        0.5 * self.mass * self.speed * self.speed
    }
}

/// Velocity of a rigid body during a step: a translation, or a rotation about a pivot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RigidVelocity {
    /// Velocity of the translation, m/s; zero if the body rotates.
    pub velocity: DVec2,
    /// Angular velocity, rad/s, positive anticlockwise.
    pub spin: f64,
    /// Pivot of the rotation, m.
    pub pivot: DVec2,
}

/// Displacement of a rigid body in a step: a translation, or a rotation about a pivot.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Carry {
    /// Translation, m; zero if the body rotates.
    pub by: DVec2,
    /// Rotation angle, rad.
    pub angle: f64,
    /// Pivot of the rotation, m.
    pub pivot: DVec2,
    /// Cosine and sine of the rotation angle.
    turn: DVec2,
}

impl RigidVelocity {
    pub(crate) const NONE: Self = Self { velocity: DVec2::ZERO, spin: 0.0, pivot: DVec2::ZERO };

    pub(super) fn straight(velocity: DVec2) -> Self {
        Self { velocity, ..Self::NONE }
    }

    pub(super) fn round(pivot: DVec2, spin: f64) -> Self {
        Self { spin, pivot, ..Self::NONE }
    }

    /// Returns the velocity, m/s, of the point of the rigid body at `place` (m).
    #[inline]
    pub(crate) fn at(&self, place: DVec2) -> DVec2 {
        if self.spin == 0.0 { self.velocity } else { self.spin * (place - self.pivot).perp() }
    }

    /// Returns the mean velocity, m/s, in the next `secs` seconds, of the point of the rigid body that is now at c =
    /// `place`: (R − 1)(c − p)/Δt, with the pivot p (m), the time Δt = `secs` (s) and the rotation matrix R of this
    /// time; 1 is the unit matrix. If the body does not rotate, it is the velocity of the translation.
    #[inline]
    pub(crate) fn mean_from(&self, place: DVec2, secs: f64) -> DVec2 {
        self.mean(place, secs, -1.0)
    }

    /// Returns the mean velocity, m/s, in the last `secs` seconds, of the point of the rigid body that is now at c =
    /// `place`: (1 − R⁻¹)(c − p)/Δt, with the pivot p (m), the time Δt = `secs` (s) and the rotation matrix R of this
    /// time; 1 is the unit matrix. If the body does not rotate, it is the velocity of the translation.
    #[inline]
    pub(crate) fn mean_until(&self, place: DVec2, secs: f64) -> DVec2 {
        self.mean(place, secs, 1.0)
    }

    /// Returns the mean velocity of the point of the rigid body that is now at `place`, m/s: over the next `secs`
    /// seconds if `sign` is −1, and over the last `secs` seconds if `sign` is +1. In a rotation the mean velocity has a
    /// component along the radius, towards the pivot for −1 and away from it for +1.
    fn mean(&self, place: DVec2, secs: f64, sign: f64) -> DVec2 {
        if self.spin == 0.0 {
            return self.velocity;
        }
        let half = direction(0.5 * secs * self.spin);
        let (sine, versine) = (2.0 * half.x * half.y, 2.0 * half.y * half.y);
        let offset = place - self.pivot;
        (sine * offset.perp() + sign * versine * offset) / secs
    }

    pub(crate) fn moves(&self) -> bool {
        self.velocity != DVec2::ZERO || self.spin != 0.0
    }

    pub(crate) fn carry(&self, secs: f64) -> Carry {
        let angle = secs * self.spin;
        Carry { by: secs * self.velocity, angle, pivot: self.pivot, turn: direction(angle) }
    }
}

impl Carry {
    /// Returns the new position (m) of the point of the rigid body that was at `place` before this displacement.
    pub(crate) fn place(&self, place: DVec2) -> DVec2 {
        if self.angle == 0.0 {
            place + self.by
        } else {
            self.pivot + self.turned(place - self.pivot)
        }
    }

    /// Returns the direction, after this displacement, of a vector that rotates with the rigid body.
    pub(crate) fn turned(&self, direction: DVec2) -> DVec2 {
        if self.angle == 0.0 { direction } else { self.turn.rotate(direction) }
    }

    /// Returns an upper bound for the displacement, m, of any point of the rigid body within `reach` (m) of the pivot.
    pub(crate) fn longest_way(&self, reach: f64) -> f64 {
        self.by.length() + self.angle.abs() * reach
    }

    /// True if the displacement (translation or rotation) is not zero.
    pub(crate) fn goes(&self) -> bool {
        self.by != DVec2::ZERO || self.angle != 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_even_between_its_rows_and_stays_beyond_them() {
        let (times, values) = ([1.0, 2.0, 4.0], [10.0, 20.0, 0.0]);
        let looked_at = [0.0, 1.0, 1.5, 2.0, 3.0, 4.0, 9.0];
        let found = looked_at.map(|time| at_time(&times, &values, time));
        assert_eq!(found, [10.0, 10.0, 15.0, 20.0, 10.0, 0.0, 0.0]);
        assert_eq!(at_time(&[1.0], &[7.0], 0.0), 7.0);
        assert_eq!(at_time(&[1.0], &[7.0], 2.0), 7.0);
    }

    /// Checks that the displacements of steps of different lengths add up to the displacement that the course
    /// (prescribed motion) gives for the whole time.
    #[test]
    fn steps_add_up_to_the_course() {
        let pivot = DVec2::new(1.0, -2.0);
        let table = vec![0.0, 0.1, 0.35];
        let courses = [
            MotionCourse::Straight {
                direction: DVec2::new(0.0, 3.0),
                speed: -2.0,
                travel: Some(0.5),
            },
            MotionCourse::Sine { amplitude: DVec2::new(0.1, 0.2), frequency_hz: 7.0, phase: 0.4 },
            MotionCourse::Table {
                times_secs: table.clone(),
                offsets: vec![DVec2::X, DVec2::ZERO, DVec2::new(5.0, 4.0)],
            },
            MotionCourse::Rotation { pivot, rate: 3.0, travel: Some(0.7) },
            MotionCourse::Swing { pivot, amplitude: 0.3, frequency_hz: 7.0, phase: 0.4 },
            MotionCourse::AngleTable { pivot, times_secs: table, angles: vec![1.0, 0.0, 2.5] },
        ];
        let sine = (TAU * 7.0 * 0.6 + 0.4).sin() - 0.4f64.sin();
        let straight = [DVec2::new(0.0, -0.5), sine * DVec2::new(0.1, 0.2), DVec2::new(4.0, 4.0)];
        let angles = [0.7, 0.3 * sine, 1.5];
        for (index, course) in courses.into_iter().enumerate() {
            let mut motion = Motion { course: Some(course), ..Motion::default() };
            let (mut way, mut angle) = (DVec2::ZERO, 0.0);
            for secs in [0.013; 40].into_iter().chain([0.08]) {
                let carry = motion.velocity_in(secs).carry(secs);
                (way, angle) = (way + carry.by, angle + carry.angle);
                motion.advance(secs, &carry);
            }
            let expected = straight.get(index).copied().unwrap_or_default();
            assert!(way.distance(expected) < 1e-12, "{motion:?}: {way}");
            let expected = index.checked_sub(3).map_or(0.0, |index| angles[index]);
            assert!((angle - expected).abs() < 1e-12, "{motion:?}: {angle}");
        }
    }
}
