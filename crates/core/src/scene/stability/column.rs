//! A column of n discs. The floor carries n·m·g, the k-th contact n − k of it.
//!
//! On the chain of contacts, Jacobi's iteration is P_k ← (P_{k−1} + P_{k+1})/2, with
//! P_{−1} = P_1 at the floor and P_n = 0 at the top. Its modes cos kθ ask for cos nθ = 0, so the
//! slowest shrinks by cos(π/2n) an iteration. A chain has no loops, so every order of the contacts
//! is a consistent one (D. M. Young, 1971), and Gauss–Seidel shrinks it by cos²(π/2n) a sweep.

use glam::DVec2;

use super::{DIAMETER, GRAVITY, TOUCH, disc, dry, floor};
use crate::scene::Scene;
use crate::world::{Boundary, Gravity, Physics};

/// A column of `count` discs on the floor.
pub fn column(count: usize) -> Scene {
    let place = |k: usize| (0.5 + k as f64) * (1.0 - TOUCH) - 0.5 * TOUCH;
    let mut scene = dry("column", (0..count).map(|k| disc(0.0, place(k))).collect());
    scene.boundaries = vec![floor()];
    scene
}

/// The same column lying along the x axis, gravity and all: the leanest model there is.
pub fn column_on_line(count: usize) -> Scene {
    let mut scene = column(count);
    for grain in &mut scene.grains {
        grain.position = DVec2::new(grain.position.y, 0.0);
    }
    scene.mean_diameter = DIAMETER;
    scene.physics = Physics { axes: 1, friction: false, rotation: false, cohesion: true };
    scene.gravity = Gravity::Uniform { acceleration: DVec2::new(-GRAVITY, 0.0) };
    scene.boundaries = vec![Boundary::HalfSpace { point: DVec2::ZERO, normal: DVec2::X }];
    scene
}
