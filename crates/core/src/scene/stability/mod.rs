//! Scenes that are made to break solvers. Each scene shows one known weakness of solvers and has a known correct
//! result. `slump_studies::stability` measures how far solvers are from these results.

mod boxes;
mod columns;
mod hanging;
mod heaps;
mod impacts;

use glam::DVec2;

pub use boxes::{press, pressed_places, pressing_secs, squeeze};
pub use columns::{
    ROLLING_FRICTION_OF_COLUMN, column, column_on_line, leaning_column, lift_off, logs, mass_ratio,
    overlapped,
};
pub use hanging::{breaking_bond, breaking_bond_of_cantilever, bridge, cantilever, hanging_chain};
pub use heaps::{
    FRICTION_OF_ARCH, STEEPEST_DEGREES, arch, heap, heap_far_away, heap_of, heap_on_slope, lattice,
};
pub use impacts::{WALL_DISTANCE, balls, blow, bounce, dilatancy, thin_wall};

use super::{Scene, View};
use crate::world::{Boundary, Grain, Gravity, Parameters};

/// Diameter d of a disc in the scenes of this module and, as a mean, in the experiments of
/// [`crate::scene::experiments`], m.
pub const DIAMETER: f64 = 0.01;
/// Gravity g in the scenes of this module and in the experiments of [`crate::scene::experiments`], m/s².
pub const GRAVITY: f64 = 9.8;
/// Initial overlap of discs that are meant to touch, in diameters. Solver errors within the tolerance open gaps smaller
/// than this overlap, so such discs keep touching. It is much smaller than any length that the stability tests measure.
const TOUCH: f64 = 1e-6;
/// Returns a scene with these grains under gravity, with the friction coefficient 0.5, without cohesion and without
/// restitution. `name` is the name of the scene.
pub fn dry(name: &str, grains: Vec<Grain>) -> Scene {
    let gravity = Gravity::Uniform { acceleration: DVec2::new(0.0, -GRAVITY) };
    let parameters = Parameters { friction: 0.5, ..Parameters::default() };
    let mut scene = Scene::of(name, DIAMETER, gravity, parameters, grains);
    scene.duration_secs = 0.5;
    scene
}

/// Returns a scene with these grains under gravity above the ground at y = 0, with the friction coefficient 0.5,
/// without cohesion and without restitution. `name` is the name of the scene.
fn on_floor(name: &str, grains: Vec<Grain>) -> Scene {
    Scene { boundaries: vec![floor()], ..dry(name, grains) }
}

/// Returns the rectangle that pictures of a scene show. The arguments are its lower left and its upper right corner, in
/// diameters.
pub(super) fn view(min: DVec2, max: DVec2) -> Option<View> {
    Some(View { min: DIAMETER * min, max: DIAMETER * max })
}

/// Returns a half-space whose surface passes through `point`, which is given in diameters, with the outward normal
/// `normal`.
pub(super) fn half_space(point: DVec2, normal: DVec2) -> Boundary {
    Boundary::HalfSpace { point: DIAMETER * point, normal }
}

/// Returns the ground: the half-space below y = 0.
pub(super) fn floor() -> Boundary {
    half_space(DVec2::ZERO, DVec2::Y)
}

/// Returns a disc of diameter d at rest. The position of its centre is given in diameters.
fn disc(x: f64, y: f64) -> Grain {
    Grain::at_rest(DIAMETER * DVec2::new(x, y), 0.5 * DIAMETER)
}
