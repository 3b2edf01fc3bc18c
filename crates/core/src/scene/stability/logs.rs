//! A large disc on two small ones, as logs are piled.
//!
//! With the centres of the small discs (radius r) 2r apart and the large one of radius R, the
//! contacts lean by θ from the vertical, sin θ = r/(R + r). The two forces on a small disc, from
//! the floor and from the large disc, pass through its two contact points and take up no torque, so
//! the one from above is inclined by θ/2 to its contact's normal: it holds where μ ≥ tan(θ/2), and
//! for R = r, θ = 30°, at μ ≥ tan 15° = 2 − √3. The floor needs less.

use glam::DVec2;

use super::{DIAMETER, TOUCH, disc, dry, floor};
use crate::scene::Scene;
use crate::world::Grain;

/// Two discs of diameter d side by side, and on them one that is `ratio` times as large.
pub fn logs(ratio: f64) -> Scene {
    let half = 0.5 * (1.0 - TOUCH);
    let reach = 0.5 * (1.0 + ratio) - TOUCH;
    let height = 0.5 - TOUCH + (reach * reach - half * half).sqrt();
    let large = Grain::at_rest(DIAMETER * DVec2::new(0.0, height), 0.5 * DIAMETER * ratio);
    let small = |x: f64| disc(x, 0.5 - TOUCH);
    let mut scene = dry("logs", vec![small(-half), small(half), large]);
    scene.boundaries = vec![floor()];
    scene
}
