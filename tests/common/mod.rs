//! What the tests of physics share: short ways to write scenes, and comparisons that say what
//! differs.

#![allow(dead_code, reason = "every test binary uses its own part of this")]

pub mod natural_map;
pub mod schemes;

use glam::DVec2;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use slump::scene::stability::logs;
use slump::scene::{Scene, rough_base};
use slump::sim::{Remedies, Simulation, Stepper};
use slump::solver::{METHODS, Method, Ordering, SolverSettings, StopTest};
use slump::world::{Disc, Grain, Gravity, Parameters, Physics};

/// g of the scenes made here, m/s².
pub const G: f64 = 9.8;

/// The x axis alone.
pub const LINE: Physics = Physics { axes: 1, friction: false, rotation: false, cohesion: true };
/// The plane without friction.
pub const SMOOTH: Physics = Physics { axes: 2, friction: false, rotation: false, cohesion: true };
/// The plane with friction between grains that do not turn.
pub const UNTURNING: Physics = Physics { axes: 2, friction: true, rotation: false, cohesion: true };

/// Parameters with the shifted cone.
pub fn parameters(bond: f64, time_step_secs: f64, restitution: f64, friction: f64) -> Parameters {
    Parameters { bond, time_step_secs, restitution, friction, ..Parameters::default() }
}

/// δ_c of [`range`], in mean diameters.
pub const DISTANCE_IN_DIAMETERS: f64 = 0.01;

/// Parameters for the stepper `range`, without restitution.
pub fn range(bond: f64, time_step_secs: f64) -> Parameters {
    Parameters {
        debonding_distance: DISTANCE_IN_DIAMETERS,
        ..parameters(bond, time_step_secs, 0.0, 0.5)
    }
}

/// A scene under `range`, solved as loosely as by default.
pub fn ranged(
    physics: Physics,
    gravity: DVec2,
    parameters: Parameters,
    grains: Vec<Grain>,
) -> Scene {
    Scene {
        stepper: Stepper::Range,
        solver: SolverSettings::default(),
        parameters: Parameters { debonding_distance: DISTANCE_IN_DIAMETERS, ..parameters },
        ..scene(physics, gravity, parameters, grains)
    }
}

/// A grain in free flight.
pub fn weightless(grain: Grain) -> Grain {
    Grain { feels_gravity: false, ..grain }
}

/// As far as rounding allows.
pub fn tight() -> SolverSettings {
    to_residual(1e-12)
}

/// Gauss–Seidel to the given residual.
pub fn to_residual(tolerance: f64) -> SolverSettings {
    SolverSettings {
        method: Method::Nsgs,
        ordering: Ordering::default(),
        stop: StopTest::Residual,
        tolerance,
        max_sweeps: 20_000,
        warm_start: true,
        ..SolverSettings::default()
    }
}

/// Grains under uniform gravity and nothing else.
pub fn scene(
    physics: Physics,
    gravity: DVec2,
    parameters: Parameters,
    grains: Vec<Grain>,
) -> Scene {
    Scene {
        name: "test".into(),
        mean_diameter: 2.0 * grains[0].radius,
        areal_density: 1.0,
        gap_tolerance: 0.0,
        duration_secs: 1.0,
        physics,
        gravity: Gravity::Uniform { acceleration: gravity },
        stepper: Stepper::Moreau,
        parameters,
        solver: tight(),
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

/// Every stepper, with every method where it takes one.
pub fn every_way() -> Vec<(Stepper, Method)> {
    let of = |&stepper: &Stepper| {
        let count = if stepper.uses_method() { METHODS.len() } else { 1 };
        METHODS.iter().take(count).map(move |info| (stepper, info.method))
    };
    Stepper::ALL.iter().flat_map(of).collect()
}

/// Those of [`every_way`] whose impulses are what moves the grains, so that momentum and energy balance.
pub fn every_way_that_balances() -> Vec<(Stepper, Method)> {
    every_way().into_iter().filter(|way| way.0 != Stepper::Avbd).collect()
}

/// A simulation of a scene that has no fault.
pub fn start(scene: &Scene) -> Simulation {
    scene.simulation().expect("a proper scene")
}

/// Where grains are and how they move, bit by bit: `==` would take −0 for 0 and a NaN for a difference.
pub fn bits(simulation: &Simulation) -> Vec<[u64; 6]> {
    let grains = &simulation.world().grains;
    let of = |k: usize| {
        let [at, velocity] = [grains.positions[k], grains.velocities[k]];
        let turn = [grains.angles[k], grains.angular_velocities[k]];
        [at.x, at.y, velocity.x, velocity.y, turn[0], turn[1]].map(f64::to_bits)
    };
    (0..grains.len()).map(of).collect()
}

/// Takes `count` steps.
pub fn take_steps(simulation: &mut Simulation, count: usize) {
    for _ in 0..count {
        simulation.step().expect("a finite state");
    }
}

/// A disc with a velocity.
pub fn moving(position: DVec2, radius: f64, velocity: DVec2) -> Grain {
    Grain { velocity, ..Grain::at_rest(position, radius) }
}

/// Fails unless the two differ by at most `tolerance` times the larger one.
#[track_caller]
pub fn assert_close(found: f64, expected: f64, tolerance: f64, what: &str) {
    let scale = found.abs().max(expected.abs());
    assert!(
        (found - expected).abs() <= tolerance * scale,
        "{what}: found {found:e}, expected {expected:e}, off by {:e} of it",
        (found - expected).abs() / scale
    );
}

/// A generator with a seed.
pub fn random(seed: u64) -> Pcg64 {
    Pcg64::seed_from_u64(seed)
}

/// `count` discs, pressed together on a lattice over a rough base so that about
/// half of all neighbours overlap, with velocities of about `speed` (m/s) and like spins.
pub fn pressed_pile(count: usize, speed: f64, seed: u64, parameters: Parameters) -> Scene {
    let mut random = random(seed);
    let diameter = 5e-3;
    let columns = (count as f64).sqrt().ceil() as usize;
    let grains = (0..count)
        .map(|index| {
            let radius = 0.5 * diameter * random.random_range(0.9..=1.1);
            let (row, column) = (index / columns, index % columns);
            let shift = if row % 2 == 0 { 0.0 } else { 0.5 };
            let place = DVec2::new(
                column as f64 - 0.5 * columns as f64 + shift,
                0.5 + (0.75f64).sqrt() * row as f64,
            );
            let jitter =
                DVec2::new(random.random_range(-0.05..0.05), random.random_range(-0.05..0.05));
            let mut component = || speed * random.random_range(-1.0..=1.0);
            Grain {
                velocity: DVec2::new(component(), component()),
                angular_velocity: component() / radius,
                ..Grain::at_rest(diameter * (place + jitter), radius)
            }
        })
        .collect();
    Scene {
        fixed_discs: rough_base(columns as f64 + 2.0, diameter),
        ..scene(Physics::FULL, DVec2::new(0.0, -G), parameters, grains)
    }
}

/// Logs at rest, and beside them a spinning disc that falls on the floor, one that has to be pushed out
/// of it, and one whose bond to it is stretched and holds. None touches another: where friction leaves
/// more than one solution, rounding would choose.
pub fn at_rest_and_falling() -> Scene {
    let mut scene = logs(1.0);
    let aside = |x: f64, y: f64| Grain::at_rest(scene.mean_diameter * DVec2::new(x, y), 0.005);
    let falling = Grain { angular_velocity: 30.0, ..aside(-5.0, 1.6) };
    let stretching = Grain { velocity: DVec2::new(0.0, 0.05), ..aside(5.0, 0.4999) };
    let overlapping = aside(-10.0, 0.45);
    scene.grains.extend([falling, overlapping, stretching]);
    scene.parameters.restitution = 0.5;
    scene.parameters.bond = 2.0;
    scene.solver.stop = StopTest::Residual;
    scene.solver.tolerance = 1e-11;
    scene.solver.max_sweeps = 20_000;
    scene
}

/// A fixed disc.
pub fn fixed(position: DVec2, radius: f64) -> Disc {
    Disc { position, radius }
}
