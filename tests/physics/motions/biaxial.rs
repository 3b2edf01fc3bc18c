//! A box of grains whose walls press them together: at rest each wall carries its own force.

use super::driven::{by_force, carried, driven};
use crate::common::*;

/// N.
const FORCE: f64 = 0.03;

/// 36 discs of different sizes, loosely between a floor and three walls that press with the same force.
fn pressed_together(seed: u64) -> Scene {
    let mut random = random(seed);
    let grain = |k: i32| {
        let place = 0.025 * DVec2::new(f64::from(k % 6), f64::from(k / 6));
        Grain::at_rest(place, random.random_range(0.008..0.012))
    };
    let grains = (0..36).map(grain).collect();
    let mut scene = without_g(parameters(0.0, 1e-3, 0.0, 0.3), grains);
    let wall =
        |x: f64, y: f64, normal: DVec2| Boundary::HalfSpace { point: DVec2::new(x, y), normal };
    scene.boundaries = vec![
        wall(0.0, -0.013, DVec2::Y),
        wall(-0.013, 0.0, DVec2::X),
        wall(0.138, 0.0, DVec2::NEG_X),
        wall(0.0, 0.138, DVec2::NEG_Y),
    ];
    let walls = [(1, DVec2::X), (2, DVec2::NEG_X), (3, DVec2::NEG_Y)];
    scene.motions =
        walls.map(|(wall, direction)| driven(&[wall], by_force(direction, FORCE, 0.01))).into();
    (scene.solver.method, scene.solver.tolerance) = (Method::Nsgs, 1e-12);
    scene.solver.max_sweeps = 20_000;
    scene
}

#[test]
fn walls_that_press_a_packing_at_rest_carry_each_its_force() {
    for seed in [1, 2] {
        let run = after(&pressed_together(seed), 2500);
        // Grains that nothing holds may float; those that bear the walls are at rest when the walls are.
        for motion in &run.world().motions {
            let speed = motion.drive.as_ref().expect("a drive").speed;
            assert!(speed.abs() < 1e-9, "{speed} m/s, seed {seed}: {:?}", run.observables());
        }
        // What the floor lacks, friction at the sides carries.
        for wall in 1..4 {
            assert_close(carried(&run, wall), FORCE, 1e-8, &format!("wall {wall}, seed {seed}"));
        }
    }
}

fn stress_ratio(run: &Simulation) -> f64 {
    let pile = slump::granular::measure(&run.moment()).pile;
    pile.stress_yy / pile.stress_xx
}

#[test]
fn the_shipped_test_compresses_and_bears_more_along_than_across() {
    let mut run = start(&built_in("biaxial").expect("a scene"));
    let mut ratios = Vec::new();
    while run.time_secs() < 1.2 {
        take_steps(&mut run, 20);
        if run.time_secs() > 0.6 {
            ratios.push(stress_ratio(&run));
        }
    }
    // What a single moment has moves by a fifth; forty of them leave some hundredths.
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    assert!(ratios.len() > 40 && (1.4..2.6).contains(&mean), "{mean} of {}", ratios.len());
    assert_eq!(run.observables().lost_grains, 0);
}
