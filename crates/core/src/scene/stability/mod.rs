//! Scenes made to break methods: each drives one known weakness and has a right answer. What is
//! measured on them is in `study::stability`.

mod arch;
mod balls;
mod blow;
mod bounce;
mod column;
mod dilatancy;
mod hanging;
mod heap;
mod lattice;
mod lift_off;
mod logs;
mod mass_ratio;
mod overlapped;
pub mod press;
mod slope;
mod squeeze;
mod thin_wall;
mod truss;

use glam::DVec2;

pub use arch::{FRICTION_OF_ARCH, arch};
pub use balls::balls;
pub use blow::blow;
pub use bounce::bounce;
pub use column::{column, column_on_line};
pub use dilatancy::dilatancy;
pub use hanging::{breaking_bond, hanging_chain};
pub use heap::heap_far_away;
pub use heap::{heap, heap_of};
pub use lattice::lattice;
pub use lift_off::lift_off;
pub use logs::logs;
pub use mass_ratio::mass_ratio;
pub use overlapped::overlapped;
pub use press::{press, pressed_places, pressing_secs};
pub use slope::{STEEPEST_DEGREES, heap_on_slope};
pub use squeeze::squeeze;
pub use thin_wall::{WALL_DISTANCE, thin_wall};
pub use truss::bridge;
pub use truss::{breaking_bond_of_cantilever, cantilever};

use super::Scene;
use crate::sim::{Remedies, Stepper};
use crate::solver::SolverSettings;
use crate::world::{Boundary, Grain, Gravity, Parameters, Physics};

/// d of all these scenes, m.
pub const DIAMETER: f64 = 0.01;
/// g, m/s².
pub const GRAVITY: f64 = 9.8;
/// Overlap of discs that touch at the start, in diameters: more than a well solved step opens them
/// by, and far less than any measure.
const TOUCH: f64 = 1e-6;
/// The time step unless the scene is about it, s.
const TIME_STEP_SECS: f64 = 1e-3;

/// Grains under gravity, without cohesion and restitution.
pub fn dry(name: &str, grains: Vec<Grain>) -> Scene {
    Scene {
        name: name.into(),
        mean_diameter: DIAMETER,
        areal_density: 1.0,
        gap_tolerance: 0.0,
        duration_secs: 0.5,
        physics: Physics::FULL,
        gravity: Gravity::Uniform { acceleration: DVec2::new(0.0, -GRAVITY) },
        stepper: Stepper::Moreau,
        parameters: Parameters {
            bond: 0.0,
            time_step_secs: TIME_STEP_SECS,
            restitution: 0.0,
            friction: 0.5,
            ..Parameters::default()
        },
        solver: SolverSettings::default(),
        remedies: Remedies::default(),
        view: None,
        source: None,
        data: None,
        boundaries: Vec::new(),
        motions: Vec::new(),
        gravity_turn: None,
        periodic: None,
        fixed_discs: Vec::new(),
        grains,
    }
}

/// The ground: all below y = 0.
fn floor() -> Boundary {
    Boundary::HalfSpace { point: DVec2::ZERO, normal: DVec2::Y }
}

/// A disc of diameter d at rest, at a place in diameters.
fn disc(x: f64, y: f64) -> Grain {
    Grain::at_rest(DIAMETER * DVec2::new(x, y), 0.5 * DIAMETER)
}
