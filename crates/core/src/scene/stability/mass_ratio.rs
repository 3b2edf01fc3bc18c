//! A heavy disc on a light one. With R the ratio of their masses, Gauss–Seidel on the two contacts
//! shrinks its error by W₀₁²/(W₀₀W₁₁) = R/(R + 1) a sweep: it needs sweeps by the R.

use glam::DVec2;

use super::{DIAMETER, TOUCH, disc, dry, floor};
use crate::scene::Scene;
use crate::world::Grain;

/// A disc of diameter d, and on it one that is `ratio` times as heavy.
pub fn mass_ratio(ratio: f64) -> Scene {
    let radius = 0.5 * ratio.sqrt();
    let heavy =
        Grain::at_rest(DIAMETER * DVec2::new(0.0, 1.0 + radius - 2.0 * TOUCH), DIAMETER * radius);
    let mut scene = dry("mass-ratio", vec![disc(0.0, 0.5 - TOUCH), heavy]);
    scene.boundaries = vec![floor()];
    scene
}
