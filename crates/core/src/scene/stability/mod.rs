//! Scenes made to break solvers. Each drives one known weakness and has a known correct answer.
//! `slump_studies::stability` measures them.

mod boxes;
mod columns;
mod hanging;
mod heaps;
mod impacts;

use glam::DVec2;

pub use boxes::{press, pressed_places, pressing_secs, squeeze};
pub use columns::{column, column_on_line, lift_off, logs, mass_ratio, overlapped};
pub use hanging::{breaking_bond, breaking_bond_of_cantilever, bridge, cantilever, hanging_chain};
pub use heaps::{
    FRICTION_OF_ARCH, STEEPEST_DEGREES, arch, heap, heap_far_away, heap_of, heap_on_slope, lattice,
};
pub use impacts::{WALL_DISTANCE, balls, blow, bounce, dilatancy, thin_wall};

use super::{Scene, View};
use crate::world::{Boundary, Grain, Gravity, Parameters};

/// Diameter d of all these scenes, m.
pub const DIAMETER: f64 = 0.01;
/// Gravity g, m/s².
pub const GRAVITY: f64 = 9.8;
/// Overlap of discs that touch at the start, in diameters: more than a well solved step opens them, and far less than
/// any measured length.
const TOUCH: f64 = 1e-6;
/// A scene of grains under gravity, without cohesion and restitution.
pub fn dry(name: &str, grains: Vec<Grain>) -> Scene {
    let gravity = Gravity::Uniform { acceleration: DVec2::new(0.0, -GRAVITY) };
    let parameters = Parameters { friction: 0.5, ..Parameters::default() };
    let mut scene = Scene::of(name, DIAMETER, gravity, parameters, grains);
    scene.duration_secs = 0.5;
    scene
}

/// Like [`dry`], with the ground.
fn on_floor(name: &str, grains: Vec<Grain>) -> Scene {
    Scene { boundaries: vec![floor()], ..dry(name, grains) }
}

/// A view with corners in diameters.
pub(super) fn view(min: DVec2, max: DVec2) -> Option<View> {
    Some(View { min: DIAMETER * min, max: DIAMETER * max })
}

/// A half-space through a point in diameters.
pub(super) fn half_space(point: DVec2, normal: DVec2) -> Boundary {
    Boundary::HalfSpace { point: DIAMETER * point, normal }
}

/// The ground: all below y = 0.
pub(super) fn floor() -> Boundary {
    half_space(DVec2::ZERO, DVec2::Y)
}

/// A disc of diameter d at rest, at a place in diameters.
fn disc(x: f64, y: f64) -> Grain {
    Grain::at_rest(DIAMETER * DVec2::new(x, y), 0.5 * DIAMETER)
}
