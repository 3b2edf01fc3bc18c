//! Discs at rest in a box, shared by all benchmarks.

#![allow(dead_code, reason = "every bench uses its own part of this")]

pub mod timing;

use glam::DVec2;
use slump::scene::{Scene, pile_of};
use slump::sim::Simulation;
use slump::solver::{Approach, ProblemNumbers, SolverSettings, SpinningPlane, StepProblem};
use slump::world::{Boundary, Grain, Parameters};

/// Mean diameter d of the pile scene, m.
const DIAMETER: f64 = 5e-3;

/// Returns the contact problem of the simulation's next step.
pub fn problem(simulation: &Simulation, settings: &SolverSettings) -> StepProblem<SpinningPlane> {
    let (world, parameters) = (simulation.world(), simulation.parameters());
    let Parameters { time_step_secs, friction, restitution, cone, .. } = *parameters;
    let capture_speed = parameters.capture_speed(world.gravity.magnitude());
    let rolling_friction = 0.0;
    let numbers =
        ProblemNumbers { time_step_secs, friction, rolling_friction, capture_speed, cone };
    let rebound = |approach: Approach| restitution * approach.velocity;
    let mut problem = StepProblem::default();
    problem.prepare(world, simulation.contacts(), numbers, settings, rebound, None, None);
    problem
}

/// Returns a simulation of `count` cohesionless discs, settled in a box as wide as the pile is high. Their contacts are
/// like the contacts of a pile. The benchmarks do not depend on how the discs fell, so the discs fall quickly.
pub fn settled(count: usize) -> Simulation {
    let columns = ((count as f64).sqrt() * 1.2).ceil() as usize;
    let spacing = 1.21 * DIAMETER;
    let mut random = 1u64;
    let mut fraction = || {
        // Any well-mixed pseudorandom sequence is suitable here (Knuth's multiplier).
        random =
            random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (random >> 11) as f64 / (1u64 << 53) as f64
    };
    let grains = (0..count)
        .map(|index| {
            let radius = 0.5 * DIAMETER * (0.8 + 0.4 * fraction());
            let column = (index % columns) as f64 - 0.5 * (columns - 1) as f64;
            let row = (index / columns) as f64 + 1.1;
            let shift = (0.5 * spacing - radius) * (2.0 * fraction() - 1.0);
            Grain::at_rest(spacing * DVec2::new(column, row) + DVec2::new(shift, 0.0), radius)
        })
        .collect();
    let width_in_diameters = columns as f64 * 1.21;
    let wall = |side: f64| Boundary::HalfSpace {
        point: DVec2::new(side * 0.5 * width_in_diameters * DIAMETER, 0.0),
        normal: DVec2::new(-side, 0.0),
    };
    let pile = pile_of(grains, width_in_diameters).expect("a pile");
    let mut scene = Scene {
        boundaries: vec![wall(-1.0), wall(1.0)],
        parameters: Parameters { bond: 0.0, time_step_secs: 5e-4, ..pile.parameters },
        ..pile
    };
    scene.solver.max_sweeps = 30;
    let mut simulation = scene.simulation().expect("a proper scene");
    for step in 0..800 {
        simulation.step().expect("a finite state");
        if step % 10 == 0 {
            simulation.scale_velocities(0.9);
        }
    }
    simulation.bring_to_rest();
    simulation
}

/// Returns a copy of a simulation in the same state with changed parameters.
pub fn with(simulation: &Simulation, change: impl FnOnce(&mut Parameters)) -> Simulation {
    let mut simulation = simulation.clone();
    let mut parameters = *simulation.parameters();
    change(&mut parameters);
    simulation.set_parameters(parameters).expect("proper parameters");
    simulation
}
