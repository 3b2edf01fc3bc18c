//! The heap of `heap` on a slope. It stands up to an inclination of exactly 30°, whatever its size and
//! for every friction below √3.
//!
//! Up to 30° every disc can rest on the two below it without friction. Their forces f₁ (up the slope of
//! it) and f₂ (down the slope) run along the lattice, at 60° to the base. With θ the inclination and w a
//! disc's weight, they ask for (f₁ + f₂) sin 60° = w cos θ and (f₂ − f₁) cos 60° = w sin θ, so that
//!
//! > f₁ = w (cos θ/√3 − sin θ) ≥ 0  where tan θ ≤ 1/√3;
//!
//! what a disc gets from above passes straight on to the one below, and the sums along each line of
//! the lattice push as well.
//!
//! Beyond 30° the weight of the highest disc passes below its lower contact, about which it turns: its
//! upper contact opens at 30° to that contact's normal, which only friction of at least tan 60° = √3
//! could hold. Without friction the whole base would have to pull, Σf₁ < 0, so that nothing holds.
//!
//! A heap of grains poured at random has no such value: its angle of repose is a matter of its past.

use glam::DVec2;

use super::{DIAMETER, heap};
use crate::scene::{Scene, View};

/// The steepest slope on which the heap stands, degrees.
pub const STEEPEST_DEGREES: f64 = 30.0;

/// The heap of `rows` rows on a base that falls to the right at `degrees`.
pub fn heap_on_slope(rows: usize, degrees: f64) -> Scene {
    let mut scene = heap(rows);
    scene.name = "repose-angle".into();
    let slope = DVec2::from_angle(-degrees.to_radians());
    for position in scene.grains.iter_mut().map(|grain| &mut grain.position) {
        *position = slope.rotate(*position);
    }
    for position in scene.fixed_discs.iter_mut().map(|disc| &mut disc.position) {
        *position = slope.rotate(*position);
    }
    let half = 0.5 * rows as f64 + 3.0;
    scene.view = Some(View {
        min: DIAMETER * DVec2::new(-half, -0.6 * half),
        max: DIAMETER * DVec2::new(half, rows as f64 + 1.0),
    });
    scene
}
