//! The methods against each other: one problem, one answer.

use slump::scene::{Rain, Scene, cradle, pile_of, settle};
use slump::sim::Simulation;
use slump::solver::{Method, SolverSettings, StopTest};
use slump::world::{FrictionCone, Physics};

/// A small pile that has begun to fall.
fn falling_pile(seed: u64) -> Scene {
    let rain = Rain { grains: 50, box_width_in_diameters: 9.0, seed };
    let grains = settle(&rain, |_| true).expect("a pile at rest");
    let mut scene = pile_of(grains, rain.box_width_in_diameters);
    scene.parameters.restitution_threshold = 2.0;
    scene
}

fn with(scene: &Scene, method: Method, tolerance: f64) -> Simulation {
    let stop = StopTest::Residual;
    let solver = SolverSettings {
        method,
        stop,
        tolerance,
        max_sweeps: 200_000,
        ..SolverSettings::default()
    };
    Scene { solver, ..scene.clone() }.simulation().expect("a proper scene")
}

/// Without friction the velocities of a step are unique, so a tight solve has one answer.
#[test]
fn newton_and_sweeps_agree_on_the_velocities_of_a_frictionless_pile() {
    for (seed, rotation) in [(1, true), (2, false)] {
        let mut scene = falling_pile(seed);
        scene.parameters.friction = 0.0;
        scene.parameters.bond = 5.0;
        if !rotation {
            scene.physics = Physics { friction: false, rotation: false, ..Physics::FULL };
        }
        let mut sweeps = with(&scene, Method::Nsgs, 1e-10);
        let mut newton = with(&scene, Method::Newton, 1e-10);
        let mut fastest = 0f64;
        for _ in 0..30 {
            let by_sweeps = *sweeps.step().expect("a finite state");
            let by_newton = *newton.step().expect("a finite state");
            assert!(by_sweeps.converged && by_newton.converged);
            for (a, b) in
                sweeps.world().grains.velocities.iter().zip(&newton.world().grains.velocities)
            {
                fastest = fastest.max(a.length());
                assert!((*a - *b).length() < 1e-6 * fastest.max(1e-3), "{a} against {b}");
            }
            // From one state each: a difference would grow in a pile.
            newton = with(&scene, Method::Newton, 1e-10);
            sweeps = with(&scene, Method::Nsgs, 1e-10);
            scene = advanced(&scene);
        }
        assert!(fastest > 0.01, "the pile fell, at up to {fastest} m/s");
    }
}

/// The scene a few steps later.
fn advanced(scene: &Scene) -> Scene {
    let mut simulation = with(scene, Method::Nsgs, 1e-8);
    for _ in 0..5 {
        simulation.step().expect("a finite state");
    }
    let grains = &simulation.world().grains;
    Scene { grains: (0..grains.len()).map(|index| grains.grain(index)).collect(), ..scene.clone() }
}

#[test]
fn newton_solves_nearly_all_steps_of_a_moving_pile_in_less_than_half_the_sweeps() {
    for (seed, cone, rotation) in [
        (3, FrictionCone::Shifted, true),
        (4, FrictionCone::Compressive, true),
        (5, FrictionCone::Shifted, false),
    ] {
        let mut scene = falling_pile(seed);
        scene.parameters.cone = cone;
        scene.physics.rotation = rotation;
        scene.parameters.bond = 10.0;
        let run = |method| {
            let mut simulation = with(&scene, method, 1e-8);
            let (mut unsolved, mut sweeps) = (0, 0);
            for _ in 0..200 {
                let step = *simulation.step().expect("a finite state");
                unsolved += u32::from(!step.converged);
                sweeps += step.sweeps;
                assert!(!step.converged || step.residual <= 1e-8 * (1.0 + 1e-6));
            }
            assert!(simulation.observables().kinetic_energy > 0.0);
            (unsolved, sweeps)
        };
        let (unsolved, sweeps) = run(Method::Newton);
        let (_, plain_sweeps) = run(Method::Nsgs);
        assert!(unsolved <= 10, "{unsolved} of 200 steps unsolved ({cone:?}, rotation {rotation})");
        assert!(2 * sweeps < plain_sweeps, "{sweeps} sweeps against {plain_sweeps}");
    }
}

#[test]
fn newton_keeps_the_cradle_closed_where_the_exact_answer_is_closed() {
    let mut scene = cradle();
    scene.solver.method = Method::Newton;
    scene.solver.tolerance = 1e-12;
    scene.parameters.time_step_secs = 5e-4;
    let mut simulation = scene.simulation().expect("a proper scene");
    let mut met = false;
    while simulation.time_secs() < scene.duration_secs {
        met |= simulation.step().expect("a finite state").contacts == 2;
    }
    let positions = &simulation.world().grains.positions;
    let gap = positions[1].x - positions[0].x - scene.mean_diameter;
    assert!(met, "k reached the pair");
    assert!(gap < 1e-6, "the bond is open by {gap} m");
}
