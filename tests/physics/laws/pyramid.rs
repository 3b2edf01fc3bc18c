//! A pyramid of logs for which equilibrium forces exist: it stands if the touch tolerance preserves its contacts.

use crate::common::*;

const RADIUS: f64 = 0.05;
const ROWS_OF_LOGS: u32 = 6;

/// 21 logs on a floor with μ = 1.7. Their gaps are about 1e-7 d, of both signs. The tolerance is in m.
///
/// An equilibrium exists: linear programming finds forces within Coulomb's cones that carry all logs.
fn pyramid(seed: u64, gap_tolerance: f64) -> Scene {
    let mut random = random(seed);
    let mut grains = Vec::new();
    for row in 0..ROWS_OF_LOGS {
        for log in 0..ROWS_OF_LOGS - row {
            let (row, log) = (f64::from(row), f64::from(log));
            let place = DVec2::new(2.0 * log + row, 1.0 + row * 3f64.sqrt() - 1e-6);
            let mut off = || 2e-7 * random.random_range(-1.0..=1.0);
            grains.push(Grain::at_rest(RADIUS * (place + DVec2::new(off(), off())), RADIUS));
        }
    }
    let numbers = Parameters { touch_tolerance: 0.0, ..parameters(0.0, 1e-3, 0.0, 1.7) };
    Scene {
        gap_tolerance,
        solver: SolverSettings::default(),
        boundaries: vec![level()],
        ..under_g(numbers, grains)
    }
}

/// Longest distance that a log moves in a second, d.
fn farthest_way(scene: &Scene) -> f64 {
    let mut run = start(scene);
    let places = run.places().to_vec();
    take_steps(&mut run, 1000);
    farthest(&places, run.places()) / scene.mean_diameter
}

#[test]
fn a_pyramid_in_equilibrium_stands_with_a_touch_tolerance() {
    let tolerance = 1e-5 * 2.0 * RADIUS;
    for seed in 0..4 {
        let way = farthest_way(&pyramid(seed, tolerance));
        assert!(way < 1e-3, "start {seed}: a log went {way} d");
    }
    // The pyramid also stands by default, with contacts within the tolerance that push only at gap 0.
    for seed in 0..12 {
        let mut scene = pyramid(seed, 0.0);
        scene.parameters.touch_tolerance = Parameters::default().touch_tolerance;
        let way = farthest_way(&scene);
        assert!(way < 1e-3, "start {seed}: a log went {way} d");
    }
    // Without a tolerance, rounding opens and closes contacts and the pyramid falls.
    let way = farthest_way(&pyramid(0, 0.0));
    assert!(way > 0.05, "a log went {way} d");
}
