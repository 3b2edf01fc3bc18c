//! A silo with a flat bottom and an orifice in the middle of it. A plate closes it, falls away, and grains flow out onto
//! a floor below.

use glam::DVec2;

use super::{lattice, of_loose_grains, view};
use crate::scene::Scene;
use crate::scene::stability::DIAMETER;
use crate::world::{Boundary, Motion, MotionCourse};

/// Width of the silo and its height, in diameters.
pub const WIDTH: f64 = 26.0;
const HEIGHT: f64 = 60.0;
/// How far below the bottom the floor lies that catches what flows out, in diameters.
const FALL: f64 = 30.0;
/// How far the plate falls, m, and in which time, s: faster than grains.
const WAY: f64 = 1.0;
const WAY_SECS: f64 = 0.1;

/// 450 grains that flow out of an orifice of seven diameters from 0.5 s on.
pub fn silo() -> Scene {
    let mut scene = silo_of(of_loose_grains("silo", lattice(450, WIDTH, 0.7)), 7.0, 0.5);
    scene.duration_secs = 2.5;
    scene.view = view(DVec2::new(-0.8 * WIDTH, -FALL - 1.0), DVec2::new(0.8 * WIDTH, 30.0));
    scene
}

/// The silo around a scene of grains, with an orifice of that width in diameters, which opens at `release_secs`.
pub fn silo_of(mut scene: Scene, orifice: f64, release_secs: f64) -> Scene {
    let corner = |x: f64, y: f64| DIAMETER * DVec2::new(x, y);
    let side = |sign: f64| Boundary::Polyline {
        points: vec![
            corner(sign * 0.5 * WIDTH, HEIGHT),
            corner(sign * 0.5 * WIDTH, 0.0),
            corner(sign * 0.5 * orifice, 0.0),
        ],
    };
    let plate =
        Boundary::Segment { from: corner(-0.5 * orifice, 0.0), to: corner(0.5 * orifice, 0.0) };
    let floor = Boundary::HalfSpace { point: corner(0.0, -FALL), normal: DVec2::Y };
    scene.boundaries = vec![side(-1.0), side(1.0), plate, floor];
    scene.motions = vec![Motion {
        boundaries: vec![2],
        course: Some(MotionCourse::Table {
            times_secs: vec![0.0, release_secs, release_secs + WAY_SECS],
            offsets: vec![DVec2::ZERO, DVec2::ZERO, DVec2::new(0.0, -WAY)],
        }),
        ..Motion::default()
    }];
    scene
}
