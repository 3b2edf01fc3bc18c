//! Tests of heaps of grains with rolling friction: a larger rolling friction coefficient makes heaps steeper and
//! shorter, until grains hardly roll.

use rayon::prelude::*;
use slump::config::Config;
use slump::granular::HeapShape;
use slump::scene::{NewPile, settle};
use slump::study::mean;

/// Rolling friction coefficients μ_r, in increasing order. At the last two of them grains hardly roll.
const ROLLING: [f64; 4] = [0.0, 0.4, 4.0, 16.0];
/// Number of initial states, each of which runs with every coefficient.
const STATES: u64 = 8;

/// Returns the angle of repose (degrees) and the run-out (m) of a heap of 60 grains without cohesion, 0.6 s after the
/// walls of its box were removed.
fn shape(seed: u64, rolling_friction: f64) -> [f64; 2] {
    let new = NewPile { grains: 60, box_width_in_diameters: 10.5, seed, ..NewPile::default() };
    let mut config = Config::default();
    config.source.set_new_pile(&new);
    config.parameters.rolling_friction = Some(rolling_friction);
    config.parameters.bond = Some(0.0);
    let scene = config.scene_from(settle(&new, |_| true).expect("at rest")).expect("a scene");
    let mut simulation = scene.simulation().expect("a simulation");
    simulation.take_steps(scene.parameters.steps_in(0.6)).expect("finite states");
    let HeapShape { repose_angle, run_out, .. } = HeapShape::of(&simulation.moment());
    [repose_angle, run_out]
}

/// Checks that rolling friction makes heaps steeper (larger angle of repose) and shorter (smaller run-out), and that
/// both effects stop growing when grains hardly roll. Rolling resistance acts like the angularity of grains (Estrada et
/// al., arXiv:1105.4418, who shear discs by Contact Dynamics). Each coefficient is tried with the same initial states.
/// The test makes four comparisons: the angle of repose and the run-out, each between the first and second and between
/// the second and third coefficient. If rolling friction had no effect, each comparison would be true by chance in 1 of
/// 40 cases.
#[test]
fn heaps_get_steeper_and_shorter_with_rolling_friction_until_grains_hardly_roll() {
    let pairs: Vec<(u64, f64)> =
        (1..=STATES).flat_map(|seed| ROLLING.map(|rolling| (seed, rolling))).collect();
    let shapes: Vec<_> = pairs.par_iter().map(|&(seed, rolling)| shape(seed, rolling)).collect();
    // Returns the mean change of a measure from one coefficient to another, with its 95 % interval.
    let change = |measure: usize, [from, to]: [usize; 2]| {
        let of_seed = |of: &[[f64; 2]]| of[to][measure] - of[from][measure];
        mean(&shapes.chunks(ROLLING.len()).map(of_seed).collect::<Vec<_>>())
    };
    for levels in [[0, 1], [1, 2]] {
        let [steeper, longer] = [0, 1].map(|measure| change(measure, levels));
        assert!(steeper.low > 0.0, "angle of repose, {levels:?}: {steeper:?}");
        assert!(longer.high < 0.0, "run-out, {levels:?}: {longer:?}");
    }
    for measure in [0, 1] {
        let [all, last] = [[0, 2], [2, 3]].map(|levels| change(measure, levels).mean);
        assert!(last.abs() < 0.2 * all.abs(), "it does not saturate: {all}, then {last}");
    }
}
