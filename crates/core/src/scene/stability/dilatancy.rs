//! A disc that slides on the floor and does not turn. It must keep its level, and stop.
//!
//! A step takes a = μ g Δt of its speed v₀, so that it slides for n = ⌊v₀/a⌋ steps and, moved with the
//! velocity that a step ends with, comes as far as
//!
//! > Δt (n v₀ − a n(n + 1)/2) = v₀²/(2μg) − v₀Δt/2 + Δt r(a − r)/(2a),  r = v₀ − n a,
//!
//! so that no step leaves it further from v₀²/(2μg) than v₀Δt/2.
//!
//! `associated` asks for v_n ≥ μ|v_t|, and of all velocities that do so takes the one nearest to the free
//! one, (v₀, −g Δt):
//!
//! > v_t = (v₀ − a)/(1 + μ²),  v_n = μ v_t.
//!
//! The disc is lifted by Δt μ v_t, has lost a share μ²/(1 + μ²) of its speed as if it had run into a
//! slope, and flies, v_n²/2g high, at any Δt.
//!
//! `desaxce` lets v_n = μ(|v_t| − |v_t| of the solve before), less than nothing for what slows down. These sum
//! up to −μ v₀ over the whole way: the disc ends μ v₀ Δt lower than it began.

use glam::DVec2;

use super::{DIAMETER, GRAVITY, TOUCH, disc, dry, floor};
use crate::scene::{Scene, View};

/// Speed at the start, in √(g d).
const SPEED: f64 = 3.0;

/// A disc on the floor, with speed.
pub fn dilatancy() -> Scene {
    let mut grain = disc(0.0, 0.5 - TOUCH);
    grain.velocity.x = SPEED * (GRAVITY * DIAMETER).sqrt();
    let mut scene = dry("dilatancy", vec![grain]);
    scene.physics.rotation = false;
    scene.boundaries = vec![floor()];
    scene.view = Some(View {
        min: DIAMETER * DVec2::new(-1.5, -0.5),
        max: DIAMETER * DVec2::new(11.5, 6.5),
    });
    scene
}
