//! A column of grains between two gates over a rough floor. The gates are pulled away, faster than grains can follow,
//! and the column spreads to both sides.
//!
//! It is half as wide as R₀ on either side and H₀ high, so that with a = H₀/R₀ and a solid fraction of 0.82 it takes
//! 2 a R₀² · 0.82/(π/4) = 2.09 a R₀²/d² grains.

use glam::DVec2;

use super::{lattice, of_loose_grains, view};
use crate::scene::Scene;
use crate::scene::rough_base;
use crate::scene::stability::DIAMETER;
use crate::world::{Boundary, Grain, Motion, MotionCourse};

/// Grains that R₀ = H₀ = d takes.
const GRAINS_OF_SQUARE: f64 = 2.09;
/// How far the gates go, m, and in which time, s: 15 m/s.
const WAY: f64 = 3.0;
const WAY_SECS: f64 = 0.2;
/// How far the rough floor reaches, in the longest way that grains are known to go: beyond it is even.
const REACH: f64 = 1.3;

/// R₀ of a column of so many grains, in diameters.
pub fn half_width(grains: usize, aspect: f64) -> f64 {
    (grains as f64 / (GRAINS_OF_SQUARE * aspect)).sqrt()
}

/// 400 grains that fall into a column twice as high as half of its width and are let go after 0.7 s.
pub fn collapse() -> Scene {
    let (grains, aspect) = (400, 2.0);
    let half = half_width(grains, aspect);
    let loose = of_loose_grains("collapse", lattice(grains, 2.0 * half, 1.2));
    let mut scene = collapse_of(loose, half, 0.7);
    scene.duration_secs = 2.5;
    scene.view = view(DVec2::new(-5.4 * half, -2.0), DVec2::new(5.4 * half, 3.6 * half));
    scene
}

/// The gates and the floor around a scene of grains, whose half width is R₀ in diameters; the gates go at
/// `release_secs`.
pub fn collapse_of(mut scene: Scene, half: f64, release_secs: f64) -> Scene {
    let top = |grain: &Grain| grain.position.y + grain.radius;
    let aspect = scene.grains.iter().map(top).fold(0.0, f64::max) / (half * DIAMETER);
    // Beyond the longest run-out that columns are known for.
    let reach = REACH * half * (1.0 + (2.5 * aspect).max(3.25 * aspect.powf(0.7)));
    scene.fixed_discs = rough_base(2.0 * reach, DIAMETER);
    let gate = |side: f64| Boundary::HalfSpace {
        point: DVec2::new(side * half * DIAMETER, 0.0),
        normal: DVec2::new(-side, 0.0),
    };
    let floor = Boundary::HalfSpace { point: DVec2::ZERO, normal: DVec2::Y };
    scene.boundaries = vec![floor, gate(-1.0), gate(1.0)];
    let pulled = |(number, side): (usize, f64)| Motion {
        boundaries: vec![number],
        course: Some(MotionCourse::Table {
            times_secs: vec![0.0, release_secs, release_secs + WAY_SECS],
            offsets: vec![DVec2::ZERO, DVec2::ZERO, DVec2::new(side * WAY, 0.0)],
        }),
        ..Motion::default()
    };
    scene.motions = [(1, -1.0), (2, 1.0)].into_iter().map(pulled).collect();
    scene
}
