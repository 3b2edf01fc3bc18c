//! Grains in a box that is shaken up and down, with a large one among them.

use std::f64::consts::TAU;

use glam::DVec2;

use super::{SPACING, of_loose_grains, view};
use crate::scene::Scene;
use crate::scene::stability::{DIAMETER, GRAVITY};
use crate::world::{Boundary, Grain, Motion, MotionCourse};

/// Half the width of the box, and its height, in diameters.
const HALF_WIDTH: f64 = 8.0;
const HEIGHT: f64 = 30.0;
/// Radius of the large grain, in diameters.
const LARGE: f64 = 1.5;
/// How often it is shaken, Hz.
const FREQUENCY_HZ: f64 = 10.0;
/// Largest acceleration of the box, in g: above 1 all that lies in it is thrown up.
const ACCELERATION: f64 = 3.0;

/// 120 grains and a large one in a box.
pub(crate) fn vibrated() -> Scene {
    let large = DVec2::new(0.0, 2.0 * SPACING + LARGE);
    let columns = |row: i32| {
        let y = 0.7 + SPACING * f64::from(row);
        (-5..=5).map(move |column| DVec2::new(1.2 * SPACING * f64::from(column), y))
    };
    let is_free = |place: &DVec2| place.distance(large) > LARGE + 0.65;
    let places = (0..12).flat_map(columns).filter(is_free).take(120);
    let mut scene = of_loose_grains("vibrated", places);
    let mut grain = Grain::at_rest(DIAMETER * large, DIAMETER * LARGE);
    grain.tone = 40;
    scene.grains.push(grain);
    let corner = |x: f64, y: f64| DIAMETER * DVec2::new(x, y);
    let points = vec![
        corner(-HALF_WIDTH, HEIGHT),
        corner(-HALF_WIDTH, 0.0),
        corner(HALF_WIDTH, 0.0),
        corner(HALF_WIDTH, HEIGHT),
    ];
    scene.boundaries = vec![Boundary::Polyline { points }];
    let amplitude = ACCELERATION * GRAVITY / (TAU * FREQUENCY_HZ).powi(2) * DVec2::Y;
    let course = MotionCourse::Sine { amplitude, frequency_hz: FREQUENCY_HZ, phase: 0.0 };
    scene.motions = vec![Motion { boundaries: vec![0], course: Some(course), ..Motion::default() }];
    scene.duration_secs = 5.0;
    scene.view = view(DVec2::new(-HALF_WIDTH - 1.0, -2.0), DVec2::new(HALF_WIDTH + 1.0, 22.0));
    scene
}
