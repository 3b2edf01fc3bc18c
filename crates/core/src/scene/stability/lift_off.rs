//! A column with a heavy disc on top that is taken away in mid-run: the impulses that carried it are
//! the start of the next step's iteration, and must not throw what is left.

use glam::DVec2;

use super::{DIAMETER, TOUCH, column, mass_ratio};
use crate::scene::Scene;
use crate::world::Grain;

/// Discs under the heavy one.
const BELOW: usize = 5;

/// A column of five, and on it, the last in the list, a disc `ratio` times as heavy.
pub fn lift_off(ratio: f64) -> Scene {
    let mut scene = column(BELOW);
    scene.name = "lift-off".into();
    let heavy = &mass_ratio(ratio).grains[1];
    let top = BELOW as f64 * (1.0 - TOUCH) - 2.0 * TOUCH;
    let position = DVec2::new(0.0, DIAMETER * top + heavy.radius);
    scene.grains.push(Grain { position, ..heavy.clone() });
    scene
}
