//! A packing between two walls that move in, without friction and open above.
//!
//! Three columns of discs stand side by side, the one in the middle higher by h; with d = 1, columns s
//! apart touch where s² + h² = 1. At the start h = 1/2, and a disc inside touches six others: more
//! contacts than freedoms. As the walls push the columns together, h grows and the discs of a column
//! part. Each disc then rests on two things below it, discs, a wall or the floor, which share its weight
//! and all above it: every contact pushes, and there are as many as freedoms. So no disc can sink, and
//! pushed slowly each has one place to be, the k-th of a column at
//!
//! > x = −s, 0 or s,  y = 1/2 + 2kh, in the middle h more,
//!
//! as long as s > 1/2, where the outer columns meet and nothing can give way any more. With more columns
//! a disc on the floor would have none but those that stand on it beside it, and they push it away.

use glam::DVec2;

use super::{DIAMETER, TOUCH, disc, dry, floor};
use crate::scene::{Scene, View};
use crate::world::Boundary;

/// Discs in a column.
const HIGH: u8 = 6;
/// Distance of columns at the end, in diameters.
const NARROWEST: f64 = 0.6;
/// Speed of each wall, m/s: the highest disc rises at half of √(g d) at most.
const SPEED: f64 = 0.007;

/// Where the discs have to be when the columns are `spacing` diameters apart, in diameters.
fn places(spacing: f64) -> Vec<DVec2> {
    let height = (1.0 - spacing * spacing).sqrt();
    let column = |x: f64, lift: f64| {
        (0..HIGH).map(move |k| DVec2::new(x, 0.5 + lift + f64::from(2 * k) * height))
    };
    column(-spacing, 0.0).chain(column(0.0, height)).chain(column(spacing, 0.0)).collect()
}

/// 18 discs and the two walls.
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
    scene.view = Some(View {
        min: DIAMETER * DVec2::new(-7.0, -0.5),
        max: DIAMETER * DVec2::new(7.0, 10.5),
    });
    scene
}

/// Where the discs have to be in the end, m, in the order of the scene's.
pub fn pressed_places() -> Vec<DVec2> {
    places(NARROWEST).into_iter().map(|place| DIAMETER * place).collect()
}

/// When the walls have come to their ends, s.
pub fn pressing_secs() -> f64 {
    DIAMETER * (0.75f64.sqrt() - NARROWEST) / SPEED
}
