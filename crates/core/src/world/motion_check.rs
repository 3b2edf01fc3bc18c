//! Checks of the motions of boundaries and fixed discs in a scene, and of the drives (forces or pressures) that move
//! them.

use std::fmt::Display;

use glam::DVec2;

use super::{Boundary, Drive, Motion, MotionCourse, Periodic};
use crate::error::{self, Error, Result};

/// Checks that the numerical values of all motions are valid and that the motions are compatible with the boundaries,
/// the number of fixed discs, the number of axes and the periodic borders of a scene.
pub(super) fn check_motions(
    motions: &[Motion],
    boundaries: &[Boundary],
    fixed_discs: usize,
    axes: u8,
    periodic: Option<Periodic>,
) -> Result<()> {
    let mut moved_by = [vec![None; boundaries.len()], vec![None; fixed_discs]];
    for (index, motion) in motions.iter().enumerate() {
        let field = format!("motions[{index}]");
        let lists = [("boundaries", &motion.boundaries), ("fixed_discs", &motion.fixed_discs)];
        if lists.iter().all(|(_, list)| list.is_empty()) {
            return Err(Error::value(field, "of no body", "of a boundary or a fixed disc"));
        }
        for ((name, list), moved_by) in lists.into_iter().zip(&mut moved_by) {
            for &body in list {
                let field = format!("{field}.{name}");
                let count = moved_by.len();
                let Some(earlier) = moved_by.get_mut(body) else {
                    let allowed = format!("below {count}, the number of {name}");
                    return Err(Error::value(field, body, allowed));
                };
                if let Some(earlier) = earlier.replace(index) {
                    let found = format!("{body}, which motions[{earlier}] moves");
                    return Err(Error::value(field, found, "a body that is named once"));
                }
                if name == "boundaries" && matches!(boundaries[body], Boundary::Piston { .. }) {
                    let found = format!("{body}, a piston");
                    return Err(Error::value(field, found, "a shape that does not move by itself"));
                }
            }
        }
        check_numbers(motion, &field)?;
        check_drive(motion, &field, periodic)?;
        if axes == 1 && (motion.turns() || motion.goes_along(1) || motion.surface_speed != 0.0) {
            let allowed = "along the x axis where physics.axes is 1";
            return Err(Error::value(field, "off the x axis", allowed));
        }
    }
    Ok(())
}

/// Checks that the drive of a motion (a force or pressure) is valid and compatible with the course (prescribed part) of
/// the motion. `field` is the name of the motion in error messages.
fn check_drive(motion: &Motion, field: &str, periodic: Option<Periodic>) -> Result<()> {
    /// Largest absolute cosine of the angle between two directions that count as perpendicular. It allows for
    /// rounding.
    const PERPENDICULAR: f64 = 1e-9;
    let Some(drive) = &motion.drive else { return Ok(()) };
    drive.check(&format!("{field}.drive"), periodic)?;
    let along = match &motion.course {
        None => return Ok(()),
        Some(MotionCourse::Straight { direction, travel: None, .. }) => *direction,
        Some(MotionCourse::Sine { amplitude, .. }) => *amplitude,
        Some(_) => {
            let allowed = "straight without a travel, or a sine, where a force drives the motion";
            return Err(Error::value(format!("{field}.course"), "of another kind", allowed));
        }
    };
    if along.dot(drive.axis()).abs() > PERPENDICULAR * along.length() {
        let allowed = "across the direction of the drive, along which the force alone moves it";
        return Err(Error::value(format!("{field}.course"), format!("along {along}"), allowed));
    }
    Ok(())
}

fn check_numbers(motion: &Motion, field: &str) -> Result<()> {
    let check = |is_sound: bool, name: &str, value: &dyn Display, allowed: &str| {
        error::check(is_sound, format!("{field}.{name}"), value, allowed)
    };
    let finite = |name: &str, value: f64| check(value.is_finite(), name, &value, "finite");
    let finite_point = |name: &str, value: DVec2| check(value.is_finite(), name, &value, "finite");
    let least = |name: &str, value: f64| {
        check(value >= 0.0 && value.is_finite(), name, &value, "a finite number ≥ 0")
    };
    finite("surface_speed", motion.surface_speed)?;
    finite("turned", motion.turned)?;
    least("elapsed_secs", motion.elapsed_secs)?;
    let Some(course) = &motion.course else { return Ok(()) };
    if let Some(pivot) = course.pivot() {
        finite_point("course.pivot", pivot)?;
    }
    let table = format!("{field}.course");
    match course {
        MotionCourse::Straight { direction, speed, travel } => {
            let length = direction.length();
            let is_sound = length > 0.0 && length.is_finite();
            check(is_sound, "course.direction", direction, "finite and not 0")?;
            finite("course.speed", *speed)?;
            least("course.travel", travel.unwrap_or(0.0))
        }
        MotionCourse::Rotation { rate, travel, .. } => {
            finite("course.rate", *rate)?;
            least("course.travel", travel.unwrap_or(0.0))
        }
        MotionCourse::Sine { amplitude, frequency_hz, phase } => {
            finite_point("course.amplitude", *amplitude)?;
            least("course.frequency_hz", *frequency_hz)?;
            finite("course.phase", *phase)
        }
        MotionCourse::Swing { amplitude, frequency_hz, phase, .. } => {
            finite("course.amplitude", *amplitude)?;
            least("course.frequency_hz", *frequency_hz)?;
            finite("course.phase", *phase)
        }
        MotionCourse::Table { times_secs, offsets } => {
            let finite = offsets.iter().map(|offset| offset.is_finite());
            check_table(&table, times_secs, "offsets", finite)
        }
        MotionCourse::AngleTable { times_secs, angles, .. } => {
            let finite = angles.iter().map(|angle| angle.is_finite());
            check_table(&table, times_secs, "angles", finite)
        }
    }
}

/// Checks that a table has valid times in increasing order and finite values. `values` contains, for each time, true if
/// the value is finite. The names of the table (`field`) and of its values (`name`) are for error messages.
pub(super) fn check_table(
    field: &str,
    times_secs: &[f64],
    name: &str,
    values: impl ExactSizeIterator<Item = bool>,
) -> Result<()> {
    if times_secs.is_empty() || times_secs.len() != values.len() {
        let found = format!("{} values at {} times", values.len(), times_secs.len());
        return Err(Error::value(format!("{field}.{name}"), found, "one at each of some times"));
    }
    for (index, time) in times_secs.iter().enumerate() {
        let rises = index == 0 || *time > times_secs[index - 1];
        if !(time.is_finite() && rises) {
            let field = format!("{field}.times_secs[{index}]");
            return Err(Error::value(field, time, "finite, and above the time before it"));
        }
    }
    for (index, finite) in values.enumerate() {
        error::check(finite, format!("{field}.{name}[{index}]"), "not finite", "finite")?;
    }
    Ok(())
}

impl Drive {
    /// Checks the numerical values of a drive (a force or pressure that moves boundaries or fixed discs). `field` is
    /// the name of the drive in error messages.
    fn check(&self, field: &str, periodic: Option<Periodic>) -> Result<()> {
        let check = |is_sound: bool, name: &str, found: &dyn Display, allowed: &str| {
            error::check(is_sound, format!("{field}.{name}"), found, allowed)
        };
        let Self { direction, force, pressure, width, mass, damping, speed } = self;
        let is_direction = direction.is_finite() && direction.length() > 0.0;
        check(is_direction, "direction", direction, "finite, and not 0")?;
        let is_mass = *mass > 0.0 && mass.is_finite();
        check(is_mass, "mass", mass, "a finite number of kg > 0")?;
        let is_damping = *damping >= 0.0 && damping.is_finite();
        check(is_damping, "damping", damping, "a finite number of kg/s ≥ 0")?;
        check(speed.is_finite(), "speed", speed, "finite")?;
        match (force, pressure) {
            (Some(force), None) => {
                check(force.is_finite(), "force", force, "a finite number of N")?;
                let allowed = "left out where no pressure is given";
                check(width.is_none(), "width", &"given", allowed)
            }
            (None, Some(pressure)) => {
                check(pressure.is_finite(), "pressure", pressure, "a finite number of N/m")?;
                let is_width = width.is_none_or(|width| width > 0.0 && width.is_finite());
                check(is_width, "width", &width.unwrap_or(0.0), "a finite number of m > 0")?;
                let is_known = width.is_some() || self.period_across(periodic).is_some();
                let allowed = "given with a pressure, unless borders are periodic and it acts across their axis";
                check(is_known, "width", &"left out", allowed)
            }
            (Some(_), Some(_)) | (None, None) => {
                let found = if force.is_some() { "given with a pressure" } else { "left out" };
                check(false, "force", &found, "given, or else a pressure, and not both")
            }
        }
    }
}
