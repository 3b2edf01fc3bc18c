//! A lattice of discs in a box that is too small for it: more contacts than the discs have freedoms,
//! and restitution that each of them asks for.

use glam::DVec2;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::{DIAMETER, GRAVITY, disc, dry};
use crate::scene::Scene;
use crate::world::Boundary;

/// Discs along each side.
const SIDE: i32 = 5;
/// Speed of each disc at the start, in √(g d).
const SPEED: f64 = 0.3;

/// 5 × 5 discs in a box that is shorter than they are by the share `strain`, along each side.
pub fn squeeze(strain: f64) -> Scene {
    let mut random = Pcg64::seed_from_u64(1);
    let speed = SPEED * (GRAVITY * DIAMETER).sqrt();
    let spacing = 1.0 - strain;
    let mut grains = Vec::new();
    for row in 0..SIDE {
        for column in 0..SIDE {
            let [x, y] = [column, row].map(|k| (f64::from(k) + 0.5) * spacing);
            let mut grain = disc(x, y);
            grain.velocity =
                speed * DVec2::new(random.random_range(-1.0..1.0), random.random_range(-1.0..1.0));
            grains.push(grain);
        }
    }
    let mut scene = dry("squeeze", grains);
    scene.parameters.restitution = 0.5;
    let end = DIAMETER * f64::from(SIDE) * spacing;
    let wall = |point: DVec2, normal: DVec2| Boundary::HalfSpace { point, normal };
    scene.boundaries = vec![
        wall(DVec2::ZERO, DVec2::Y),
        wall(DVec2::ZERO, DVec2::X),
        wall(DVec2::splat(end), -DVec2::X),
        wall(DVec2::splat(end), -DVec2::Y),
    ];
    scene
}
