//! Two bodies, one contact (paper §2.2): a disc dropped on another, fixed one.
//!
//! With A = the normal force that would give v̄ = 0, the three cases of the contact graph are: A > 0
//! bounces, −C₀ < A < 0 closes again, A < −C₀ opens. The built-in scene starts in the first and runs
//! through the others as the bounces die out.

use glam::DVec2;

use super::{Scene, View};
use crate::sim::{Remedies, Stepper};
use crate::solver::SolverSettings;
use crate::world::{Disc, Grain, Gravity, Parameters, Physics};

/// d, m.
const DIAMETER: f64 = 0.3;

/// A disc dropped from one diameter above a fixed one.
pub fn collision() -> Scene {
    let radius = 0.5 * DIAMETER;
    Scene {
        name: "collision".into(),
        mean_diameter: DIAMETER,
        areal_density: 1.0,
        gap_tolerance: 0.0,
        duration_secs: 1.5,
        physics: Physics { axes: 1, friction: false, rotation: false, cohesion: true },
        gravity: Gravity::Uniform { acceleration: DVec2::new(-2.0, 0.0) },
        stepper: Stepper::Moreau,
        parameters: Parameters {
            bond: 3.0,
            time_step_secs: 1e-3,
            restitution: 0.5,
            friction: 0.0,
            ..Parameters::default()
        },
        solver: SolverSettings::default(),
        remedies: Remedies::default(),
        view: Some(View {
            min: DIAMETER * DVec2::new(-0.7, -0.7),
            max: DIAMETER * DVec2::new(2.7, 0.7),
        }),
        source: None,
        data: None,
        boundaries: Vec::new(),
        motions: Vec::new(),
        gravity_turn: None,
        periodic: None,
        fixed_discs: vec![Disc { position: DVec2::ZERO, radius }],
        grains: vec![Grain::at_rest(DVec2::new(2.0 * DIAMETER, 0.0), radius)],
    }
}
