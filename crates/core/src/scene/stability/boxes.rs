//! Scenes of discs that are compressed between walls.

use glam::DVec2;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::{DIAMETER, GRAVITY, TOUCH, disc, dry, floor, view};
use crate::scene::Scene;
use crate::world::Boundary;

/// Number of discs in each of the three columns of the scene [`press`].
const HIGH: u8 = 6;
/// Distance between neighbouring columns when the walls of the scene [`press`] have stopped, in diameters.
const NARROWEST: f64 = 0.6;
/// Speed of each wall of the scene [`press`], m/s. It makes the highest disc rise at up to 0.13 m/s, which is below
/// half of √(g d) (gravity g, diameter d), the scale of the speeds at which discs fall. With a larger value, inertia
/// would displace the discs from their equilibrium positions.
const SPEED: f64 = 0.007;

/// Returns the exact equilibrium positions of the discs of the scene [`press`], in diameters, at the time when
/// neighbouring columns are `spacing` diameters apart.
fn places(spacing: f64) -> Vec<DVec2> {
    let height = (1.0 - spacing * spacing).sqrt();
    let column = |x: f64, lift: f64| {
        (0..HIGH).map(move |k| DVec2::new(x, 0.5 + lift + f64::from(2 * k) * height))
    };
    column(-spacing, 0.0).chain(column(0.0, height)).chain(column(spacing, 0.0)).collect()
}

/// Returns the scene of a packing between two walls that move inward, without friction and open at the top.
///
/// Three columns of discs are next to each other, and the middle column is higher by h (lengths in diameters).
/// Neighbouring columns at the distance s touch if s² + h² = 1. At the start h = 1/2, and an inner disc touches six
/// other discs, so there are more contacts than degrees of freedom. As the walls push the columns together, h grows,
/// and the discs within a column separate. Then each disc rests on two bodies below it (discs, a wall or the floor),
/// which share its weight and the load above it. All contacts push, and there are as many contacts as degrees of
/// freedom. So the contacts determine all positions, and if the walls move slowly the discs are at these positions at
/// any time. The k-th disc of a column (k = 0 for the lowest disc) is at
///
/// > x = −s, 0 or s,  y = 1/2 + 2kh, and h higher in the middle column,
///
/// as long as s > 1/2. At s = 1/2 the outer columns meet, and nothing can move any more. With more than three columns,
/// there would be a disc on the floor that does not touch a wall. Only the discs that lean on it from both sides would
/// hold it in place horizontally, and they would push it aside.
pub fn press() -> Scene {
    let widest = 0.75f64.sqrt();
    let grains = places(widest).into_iter().map(|place| place * (1.0 - TOUCH));
    let mut scene = dry("moving-walls", grains.map(|place| disc(place.x, place.y)).collect());
    scene.parameters.friction = 0.0;
    let wall = |normal: DVec2| Boundary::Piston {
        point: -DIAMETER * (widest + 0.5) * (1.0 - TOUCH) * normal,
        normal,
        speed: SPEED,
        travel: DIAMETER * (widest - NARROWEST),
    };
    scene.boundaries = vec![floor(), wall(DVec2::X), wall(-DVec2::X)];
    scene.view = view(DVec2::new(-7.0, -0.5), DVec2::new(7.0, 10.5));
    scene
}

/// Returns the exact positions that the discs of the scene [`press`] must have when its walls have stopped, m, in the
/// order of the grains of the scene.
pub fn pressed_places() -> Vec<DVec2> {
    places(NARROWEST).into_iter().map(|place| DIAMETER * place).collect()
}

/// Returns the time at which the walls of the scene [`press`] stop at their final positions, s.
pub fn pressing_secs() -> f64 {
    DIAMETER * (0.75f64.sqrt() - NARROWEST) / SPEED
}

/// Number of discs along each side of the box in the scene [`squeeze`].
const SIDE: i32 = 5;
/// Upper limit for the random initial velocities of the discs in the scene [`squeeze`], along x and along y, in units
/// of √(g d) (g: gravity, d: diameter).
const SQUEEZED_SPEED: f64 = 0.3;

/// Returns the scene of a lattice of 5 × 5 discs in a box that is too small: each side of the box is shorter than the
/// lattice by the fraction `strain`. There are more contacts than degrees of freedom, and restitution requires a
/// bounce at each contact.
pub fn squeeze(strain: f64) -> Scene {
    let mut random = Pcg64::seed_from_u64(1);
    let speed = SQUEEZED_SPEED * (GRAVITY * DIAMETER).sqrt();
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
