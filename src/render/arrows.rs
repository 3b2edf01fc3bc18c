//! Velocity arrows: one a grain, from its centre, as long as the grain is fast.

use glam::DVec2;

use super::boundaries::clip;
use super::numbers::round_above;
use super::{Camera, Colour, LinkInstance, Style};
use crate::sim::Snapshot;

/// Length of the arrow at the reference speed, in units of d.
const FULL_LENGTH: f64 = 2.5;
/// Arrows below this part of the reference are left out: they would be dots.
const LEAST_PART: f64 = 0.03;
/// Half the width of the shaft, and the length of the two barbs, in units of d.
const HALF_WIDTH: f64 = 0.05;
const BARB: f64 = 0.35;

/// The speed that is drawn at full length, m/s: the style's own, or a round number above the fastest
/// grain's; 0 where nothing moves.
pub(crate) fn speed_reference(style: &Style, snapshot: &Snapshot) -> f64 {
    if let Some(reference) = style.speed_reference {
        return reference;
    }
    let speeds = snapshot.grains.iter().map(|grain| grain.velocity.length());
    let fastest = speeds.filter(|speed| speed.is_finite()).fold(0.0, f64::max);
    // Below this a pile is at rest; arrows would show rounding.
    let least = 1e-9 * snapshot.surroundings.gravity_magnitude.max(1.0);
    if fastest > least { round_above(fastest) } else { 0.0 }
}

/// Length of the arrow at the reference speed, m.
pub(super) fn full_length(snapshot: &Snapshot) -> f64 {
    FULL_LENGTH * snapshot.surroundings.mean_diameter
}

/// The arrows of all grains that show.
pub(super) fn velocity_links(
    snapshot: &Snapshot,
    style: &Style,
    colour: Colour,
    camera: &Camera,
    width: u32,
    height: u32,
) -> Vec<LinkInstance> {
    let reference = speed_reference(style, snapshot);
    if reference.is_nan() || reference <= 0.0 {
        return Vec::new();
    }
    let diameter = snapshot.surroundings.mean_diameter;
    let half_width = camera.pixels(HALF_WIDTH * diameter).max(0.6);
    let reach = DVec2::new(f64::from(width), f64::from(height)) / 2.0 + f64::from(half_width) + 1.0;
    let mut links = Vec::new();
    for grain in &snapshot.grains {
        let part = grain.velocity / reference;
        // A velocity that is not a number is no arrow.
        if part.length().is_nan() || part.length() < LEAST_PART {
            continue;
        }
        let shaft = part * full_length(snapshot);
        let tip = grain.position + shaft;
        let barb = shaft.normalize_or_zero() * BARB * diameter * part.length().sqrt();
        let barbs =
            [DVec2::from_angle(2.6), DVec2::from_angle(-2.6)].map(|turn| tip + turn.rotate(barb));
        for (from, to) in [(grain.position, tip), (tip, barbs[0]), (tip, barbs[1])] {
            let ends = [camera.offset_px(from), camera.offset_px(to)];
            if let Some([start, end]) = clip(ends[0], ends[1], reach) {
                let (start, end) = (start.as_vec2().into(), end.as_vec2().into());
                links.push(LinkInstance { start, end, half_width, colour });
            }
        }
    }
    links
}
