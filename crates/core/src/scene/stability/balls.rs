//! Newton's cradle: a row of balls at rest that touch, and one that hits them. At ρ = 1 the last one
//! flies off with all the speed: no law that settles all impacts of a step together says so.

use glam::DVec2;

use super::{DIAMETER, GRAVITY, TOUCH, disc, dry};
use crate::scene::{Scene, View};
use crate::world::{Gravity, Physics};

/// Speed of the first ball, in √(g d).
const SPEED: f64 = 3.0;

/// One ball that hits `count` − 1 others on a line, without gravity.
pub fn balls(count: usize) -> Scene {
    let mut grains: Vec<_> = (0..count).map(|k| disc(k as f64 * (1.0 - TOUCH), 0.0)).collect();
    grains[0].position.x -= DIAMETER;
    grains[0].velocity.x = SPEED * (GRAVITY * DIAMETER).sqrt();
    let mut scene = dry("newtons-cradle", grains);
    scene.physics = Physics { axes: 1, friction: false, rotation: false, cohesion: false };
    scene.gravity = Gravity::Uniform { acceleration: DVec2::ZERO };
    scene.parameters.restitution = 1.0;
    let width = count as f64 + 6.0;
    // A little later the last ball leaves the view.
    scene.duration_secs = (count as f64 + 1.0) / SPEED * (DIAMETER / GRAVITY).sqrt();
    scene.view = Some(View {
        min: DIAMETER * DVec2::new(-2.5, -2.0),
        max: DIAMETER * DVec2::new(width, 2.0),
    });
    scene
}
