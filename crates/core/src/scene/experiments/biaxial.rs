//! A biaxial test: a box of grains whose side walls are pressed inward by a constant force each and whose lid goes
//! down at a given speed. Grains do not feel gravity.
//!
//! First the lid comes down fast onto grains that lie loosely, while the sides press them together; then it goes on
//! slowly. What they bear is told by their stress ratio σ_yy/σ_xx, which the table `measures` of a recording has: grains
//! that flow bear (1 + sin φ_f)/(1 − sin φ_f), φ_f their friction angle (Mohr, Coulomb). The height changes, so that it is
//! the force of a wall that is constant, and its pressure but for some ten per cent.

use glam::DVec2;

use super::{SPACING, lattice, of_loose_grains, view};
use crate::scene::Scene;
use crate::scene::stability::{DIAMETER, GRAVITY};
use crate::world::{Boundary, Drive, Motion, MotionCourse};

/// Number of grains.
const GRAINS: usize = 300;
/// Width of the box that they lie in at the start, in diameters.
pub const WIDTH: f64 = 19.0;
/// From the lattice to the walls, in diameters.
const ROOM: f64 = 0.75;
/// Confining pressure, in m g/d, where the walls are as high as they are in the middle of the test.
const PRESSURE: f64 = 10.0;
/// Height of the grains in the middle of the test, in diameters.
const HEIGHT: f64 = 18.0;
/// How far the lid comes down while the sides press the grains together, in diameters, and in which time, s.
const CLOSING: f64 = 5.5;
const CLOSING_SECS: f64 = 0.35;
/// How far it goes down then, in diameters, and in which time, s: γ̇ √(m/P) is 1.4e-3.
const COMPRESSION: f64 = 5.0;
const COMPRESSION_SECS: f64 = 2.0;

/// 300 grains between two walls that press and under a lid that comes down.
pub fn biaxial() -> Scene {
    let mut scene = of_loose_grains("biaxial", lattice(GRAINS, WIDTH, ROOM));
    scene.grains.iter_mut().for_each(|grain| grain.feels_gravity = false);
    // As many side by side as the lattice has.
    let columns = (WIDTH / SPACING).floor();
    let rows = (GRAINS as f64 / columns).ceil();
    let half = 0.5 * SPACING * (columns - 1.0) + ROOM;
    let top = 2.0 * ROOM + SPACING * (rows - 1.0);
    let wall = |x: f64, y: f64, normal: DVec2| Boundary::HalfSpace {
        point: DIAMETER * DVec2::new(x, y),
        normal,
    };
    scene.boundaries = vec![
        wall(0.0, 0.0, DVec2::Y),
        wall(-half, 0.0, DVec2::X),
        wall(half, 0.0, DVec2::NEG_X),
        wall(0.0, top, DVec2::NEG_Y),
    ];
    let of_grain = 0.25 * std::f64::consts::PI * DIAMETER * DIAMETER * scene.areal_density;
    let pressed = |(boundary, direction): (usize, DVec2)| Motion {
        boundaries: vec![boundary],
        drive: Some(Drive {
            direction,
            force: None,
            pressure: Some(PRESSURE * of_grain * GRAVITY / DIAMETER),
            width: Some(HEIGHT * DIAMETER),
            mass: rows * of_grain,
            damping: 0.0,
            speed: 0.0,
        }),
        ..Motion::default()
    };
    let down = |by: f64| DVec2::new(0.0, -DIAMETER * by);
    let lid = Motion {
        boundaries: vec![3],
        course: Some(MotionCourse::Table {
            times_secs: vec![0.0, CLOSING_SECS, CLOSING_SECS + COMPRESSION_SECS],
            offsets: vec![DVec2::ZERO, down(CLOSING), down(CLOSING + COMPRESSION)],
        }),
        ..Motion::default()
    };
    let sides = [(1, DVec2::X), (2, DVec2::NEG_X)].map(pressed);
    scene.motions = sides.into_iter().chain([lid]).collect();
    scene.duration_secs = CLOSING_SECS + COMPRESSION_SECS;
    scene.view = view(DVec2::new(-half - 2.0, -2.0), DVec2::new(half + 2.0, top + 2.0));
    scene
}
