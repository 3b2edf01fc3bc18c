//! A layer of grains in a flat box with a rough bottom that is tilted slowly: up to some angle it stays, then its surface
//! flows. What is tilted is gravity, so that pictures are those of someone who sits in the box.

use glam::DVec2;

use super::{lattice, of_loose_grains, view};
use crate::scene::Scene;
use crate::scene::rough_base;
use crate::scene::stability::DIAMETER;
use crate::world::{Boundary, GravityTurn, TurnCourse};

/// Width of the box and height of its walls, in diameters.
pub const WIDTH: f64 = 40.0;
const HEIGHT: f64 = 30.0;
/// How long grains come to rest before the box is tilted, s.
pub const LEVEL_SECS: f64 = 0.4;
/// How fast the box is tilted, rad/s.
pub const RATE: f64 = 0.12;
/// The steepest, rad.
const STEEPEST: f64 = 0.72;

/// 300 grains in a box that is tilted to the right, to 41 degrees.
pub fn incline() -> Scene {
    let mut scene = of_loose_grains("incline", lattice(300, WIDTH, 1.2));
    let tilting_secs = STEEPEST / RATE;
    let times_secs = vec![0.0, LEVEL_SECS, LEVEL_SECS + tilting_secs];
    let course = TurnCourse::Table { times_secs, angles: vec![0.0, 0.0, STEEPEST] };
    scene.gravity_turn = Some(GravityTurn { course, elapsed_secs: 0.0 });
    scene.fixed_discs = rough_base(WIDTH - 2.0, DIAMETER);
    let corner = |x: f64, y: f64| DIAMETER * DVec2::new(x, y);
    let points = vec![
        corner(-0.5 * WIDTH, HEIGHT),
        corner(-0.5 * WIDTH, 0.0),
        corner(0.5 * WIDTH, 0.0),
        corner(0.5 * WIDTH, HEIGHT),
    ];
    scene.boundaries = vec![Boundary::Polyline { points }];
    scene.duration_secs = LEVEL_SECS + tilting_secs;
    scene.view = view(DVec2::new(-0.55 * WIDTH, -2.0), DVec2::new(0.55 * WIDTH, 0.5 * WIDTH));
    scene
}
