//! Three discs on a line, drawn towards one of them (paper §4).
//!
//! i sits at the centre of attraction, j touches it on the right, k starts at rest on the left and
//! falls in. Whether the shock parts i and j depends on the time step, and, at small steps, on how
//! far the solver is from the solution when it stops: an exactly solved step leaves v_ij = 0.

use glam::DVec2;

use super::{Scene, View};
use crate::sim::{Remedies, Stepper};
use crate::solver::{Method, Ordering, SolverSettings, StopTest};
use crate::world::{Grain, Gravity, Parameters, Physics};

/// d, m.
const DIAMETER: f64 = 0.3;
/// The start of k, in diameters left of i, with which the paper's pattern of open and closed bonds
/// comes out. The paper does not state its own; this one was searched for.
const START_IN_DIAMETERS: f64 = 7.865;

/// The paper's cradle, with the stopping test that gives its pattern.
pub fn cradle() -> Scene {
    cradle_from(START_IN_DIAMETERS)
}

/// The cradle with k starting `start_in_diameters` left of i, centre to centre.
pub fn cradle_from(start_in_diameters: f64) -> Scene {
    let disc = |x: f64, tone: u8| Grain {
        tone,
        ..Grain::at_rest(DVec2::new(x * DIAMETER, 0.0), 0.5 * DIAMETER)
    };
    let i = disc(0.0, 255);
    let j = Grain { feels_gravity: false, ..disc(1.0, 200) };
    let k = disc(-start_in_diameters, 80);
    Scene {
        name: "cradle".into(),
        mean_diameter: DIAMETER,
        areal_density: 1.0,
        gap_tolerance: 1e-9,
        duration_secs: 2.5,
        physics: Physics { axes: 1, friction: false, rotation: false, cohesion: true },
        gravity: Gravity::Attraction { centre: DVec2::ZERO, magnitude: 2.0 },
        stepper: Stepper::Moreau,
        parameters: Parameters {
            bond: 3.0,
            time_step_secs: 5e-4,
            restitution: 0.2,
            friction: 0.0,
            ..Parameters::default()
        },
        solver: SolverSettings {
            method: Method::Nsgs,
            ordering: Ordering::Interleaved,
            stop: StopTest::ImpulsePerMass,
            tolerance: 2.2e-3,
            max_sweeps: 20_000,
            warm_start: false,
            ..SolverSettings::default()
        },
        remedies: Remedies::default(),
        view: Some(View {
            min: DIAMETER * DVec2::new(-9.0, -1.2),
            max: DIAMETER * DVec2::new(5.0, 1.2),
        }),
        source: None,
        data: None,
        boundaries: Vec::new(),
        motions: Vec::new(),
        gravity_turn: None,
        periodic: None,
        fixed_discs: Vec::new(),
        grains: vec![i, j, k],
    }
}
