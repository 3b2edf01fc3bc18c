//! Tests of a pyramid of equal discs (logs that are seen from their ends) for which equilibrium forces exist: it stands
//! if the touch tolerance preserves its contacts although positions have errors.

use crate::common::*;

const RADIUS: f64 = 0.05;
const ROWS_OF_LOGS: u32 = 6;

/// Returns a scene of 21 logs (equal discs) that form a pyramid of six rows on a floor, with the friction coefficient
/// 1.7. Random errors of up to `scatter` (in diameters) are added to each coordinate. The rows also overlap by a
/// distance of this order, so that some gaps are positive and some negative.
///
/// An equilibrium exists: linear programming finds forces that carry all logs and in which no friction force is larger
/// than the friction coefficient times the normal force.
fn pyramid(seed: u64, scatter: f64) -> Scene {
    let mut random = random(seed);
    let mut grains = Vec::new();
    for row in 0..ROWS_OF_LOGS {
        for log in 0..ROWS_OF_LOGS - row {
            let (row, log) = (f64::from(row), f64::from(log));
            let place = DVec2::new(2.0 * log + row, 1.0 + row * 3f64.sqrt() - 10.0 * scatter);
            let mut off = || 2.0 * scatter * random.random_range(-1.0..=1.0);
            grains.push(Grain::at_rest(RADIUS * (place + DVec2::new(off(), off())), RADIUS));
        }
    }
    let numbers = Parameters { touch_tolerance: 0.0, ..parameters(0.0, 1e-3, 0.0, 1.7) };
    Scene {
        gap_tolerance: 0.0,
        solver: SolverSettings::default(),
        boundaries: vec![level()],
        ..under_g(numbers, grains)
    }
}

/// Returns the longest distance that a log (disc) of the pyramid moves within one second, in diameters.
fn farthest_way(scene: &Scene) -> f64 {
    let mut run = start(scene);
    let places = run.places().to_vec();
    take_steps(&mut run, 1000);
    farthest(&places, run.places()) / scene.mean_diameter
}

#[test]
fn a_pyramid_in_equilibrium_stands_with_a_touch_tolerance() {
    let default = Parameters::default().touch_tolerance;
    // Errors of 1e-7 d and 1e-6 d, as in files that give positions with seven and six digits.
    for (scatter, seed) in pairs([1e-7, 1e-6], 0..12) {
        let mut scene = pyramid(seed, scatter);
        scene.parameters.touch_tolerance = default;
        let way = farthest_way(&scene);
        assert!(way < 1e-3, "{scatter} d, start {seed}: a log went {way} d");
    }
    // The setting `gap_tolerance` is an alternative to the touch tolerance: within it, grains also push each other.
    for seed in 0..4 {
        let scene = Scene { gap_tolerance: default * 2.0 * RADIUS, ..pyramid(seed, 1e-7) };
        let way = farthest_way(&scene);
        assert!(way < 1e-3, "start {seed}: a log went {way} d");
    }
}

/// Checks that at least half of the pyramids fall if the errors of positions are as large as the touch tolerance,
/// because contacts then open and close by chance.
#[test]
fn pyramids_fall_with_a_touch_tolerance_that_is_not_above_the_errors_of_positions() {
    for (tolerance, scatter) in [(0.0, 1e-7), (1e-7, 1e-7), (1e-6, 1e-6), (1e-5, 1e-5)] {
        let falls = |seed: &u64| {
            let mut scene = pyramid(*seed, scatter);
            scene.parameters.touch_tolerance = tolerance;
            farthest_way(&scene) > 0.05
        };
        let fallen = (0..12).filter(falls).count();
        assert!(fallen >= 6, "{tolerance} d, errors {scatter} d: {fallen} of 12 fell");
    }
}
