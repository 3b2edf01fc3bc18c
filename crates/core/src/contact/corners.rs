//! Whether corners make a shape; refused with the corner that does not.

use glam::DVec2;

use crate::error::{Error, Result};

pub(super) fn check_finite(points: &[DVec2], name: impl Fn(usize) -> String) -> Result<()> {
    match points.iter().position(|point| !point.is_finite()) {
        Some(index) => Err(Error::value(name(index), points[index], "finite")),
        None => Ok(()),
    }
}

/// Checks that corners go once around a convex polygon, anticlockwise. A pentagram turns left at each
/// corner as well, but goes around twice: on one round the direction of the sides comes but once
/// from below into the upper half of the plane.
pub(super) fn check_convex(points: &[DVec2], field: &str) -> Result<()> {
    let count = points.len();
    if count < 3 {
        return Err(Error::value(field, count_of(points, "corner"), "at least three corners"));
    }
    check_finite(points, |index| format!("{field}.points[{index}]"))?;
    let side = |k: usize| points[(k + 1) % count] - points[k % count];
    if let Some(k) = (0..count).find(|&k| side(k + count - 1).perp_dot(side(k)) <= 0.0) {
        let allowed = "a corner at which the polygon turns left: convex and anticlockwise";
        return Err(Error::value(format!("{field}.points[{k}]"), points[k], allowed));
    }
    let upwards = |side: DVec2| side.y > 0.0 || (side.y == 0.0 && side.x > 0.0);
    let rounds = (0..count).filter(|&k| !upwards(side(k)) && upwards(side(k + 1))).count();
    if rounds != 1 {
        let found = format!("{count} corners that go around {rounds} times");
        return Err(Error::value(field, found, "convex: corners that go around once"));
    }
    Ok(())
}

pub(super) fn count_of(points: &[DVec2], what: &str) -> String {
    format!("{} {what}{}", points.len(), if points.len() == 1 { "" } else { "s" })
}
