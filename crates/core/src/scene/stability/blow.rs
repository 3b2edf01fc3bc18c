//! A disc that slides along the floor, and a heavy one beside it in the air that hits it from above. Neither
//! turns, and there is no gravity: what the floor pushes is the blow and nothing else.
//!
//! All that the floor pushes, it pushes while it rubs. With M the mass of both and p_y < 0 the momentum of the
//! fall, both are level after the blow, and momentum alone says
//!
//! > M v_x = M v₀ − μ|p_y|,
//!
//! whatever happens between the two; as the lower one is M/10, a part of 0.9 μ of the blow, less than μ, has
//! them go on together. `tresca` bounds the friction of that step by what the floor bore before, nothing, and
//! that of the next one by the blow: the speed is right a step too late, and both get Δt μ|p_y|/M too far. A
//! second solve of the step knows the blow, since what the floor pushes here does not depend on friction.

use glam::DVec2;

use super::{DIAMETER, GRAVITY, mass_ratio};
use crate::scene::{Scene, View};
use crate::world::Gravity;

/// How much heavier the disc is that falls.
const RATIO: f64 = 9.0;
/// Speeds of both along the floor, and of the fall, in √(g d).
const SLIDING: f64 = 6.0;
const FALLING: f64 = 2.0;
/// The height that it falls from, in d: the disc below has been solved before the blow at every Δt.
const HEIGHT: f64 = 0.05;

/// The two discs, the heavy one second.
pub fn blow() -> Scene {
    let mut scene = mass_ratio(RATIO);
    scene.name = "blow".into();
    scene.physics.rotation = false;
    scene.gravity = Gravity::Uniform { acceleration: DVec2::ZERO };
    let scale = (GRAVITY * DIAMETER).sqrt();
    for grain in &mut scene.grains {
        grain.velocity.x = SLIDING * scale;
    }
    let falling = &mut scene.grains[1];
    falling.position.y += HEIGHT * DIAMETER;
    falling.velocity.y = -FALLING * scale;
    scene.view = Some(View {
        min: DIAMETER * DVec2::new(-2.5, -0.5),
        max: DIAMETER * DVec2::new(20.5, 13.5),
    });
    scene
}
