//! A drum that turns about its axis, two fifths full: its wall is rough by discs that turn with it, and every sixth of
//! them is larger, so that one sees it turn.

use std::f64::consts::TAU;

use glam::DVec2;

use super::{SPACING, of_loose_grains, view};
use crate::scene::Scene;
use crate::scene::stability::DIAMETER;
use crate::world::{Boundary, Disc, Motion, MotionCourse};

/// Inner radius of the drum, in diameters.
const RADIUS: f64 = 12.0;
/// Sides of its wall, and discs on it: they are nearly a diameter apart.
const SIDES: usize = 72;
/// Ω, rad/s: Ω²R/g is 0.05, at which grains roll down a steady slope.
pub const RATE: f64 = 2.0;

/// 150 grains in a drum.
pub fn drum() -> Scene {
    let columns = |row: i32| {
        let y = SPACING * f64::from(row) - 0.78 * RADIUS;
        let wide = ((RADIUS - 1.4).powi(2) - y * y).max(0.0).sqrt();
        let half = (wide / SPACING).floor() as i32;
        (-half..=half).map(move |column| DVec2::new(SPACING * f64::from(column), y))
    };
    let mut scene = of_loose_grains("drum", (0..12).flat_map(columns).take(150));
    let on_rim = |k: usize, radius: f64| {
        DIAMETER * radius * DVec2::from_angle(TAU * (k % SIDES) as f64 / SIDES as f64)
    };
    let rough = |k: usize| Disc {
        position: on_rim(k, RADIUS),
        radius: DIAMETER * if k.is_multiple_of(6) { 0.6 } else { 0.3 },
    };
    scene.fixed_discs = (0..SIDES).map(rough).collect();
    let points = (0..=SIDES).map(|k| on_rim(k, RADIUS)).collect();
    scene.boundaries = vec![Boundary::Polyline { points }];
    let course = MotionCourse::Rotation { pivot: DVec2::ZERO, rate: RATE, travel: None };
    scene.motions = vec![Motion {
        boundaries: vec![0],
        fixed_discs: (0..SIDES).collect(),
        course: Some(course),
        ..Motion::default()
    }];
    scene.duration_secs = 3.0;
    scene.view = view(DVec2::splat(-RADIUS - 1.0), DVec2::splat(RADIUS + 1.0));
    scene
}
