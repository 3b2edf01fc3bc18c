//! A disc dropped on the floor. It rises to ρ² of its height, and for ρ < 1 it is at rest after
//! infinitely many bounces, at √(2h/g)·(1 + ρ)/(1 − ρ).

use glam::DVec2;

use super::{DIAMETER, GRAVITY, disc, dry, floor};
use crate::scene::{Scene, View};

/// Height that it falls, in diameters.
const DROP: f64 = 5.0;

/// A disc above the floor.
pub fn bounce(restitution: f64) -> Scene {
    let mut scene = dry("bounce", vec![disc(0.0, DROP + 0.5)]);
    scene.parameters.restitution = restitution;
    scene.boundaries = vec![floor()];
    scene.view = Some(View {
        min: DIAMETER * DVec2::new(-4.5, -0.5),
        max: DIAMETER * DVec2::new(4.5, DROP + 1.5),
    });
    scene.duration_secs = 10.0 * (2.0 * DROP * DIAMETER / GRAVITY).sqrt();
    scene
}
