//! Gravity that turns: what falls freely, what a box that is tilted lets slide, and the budget of energy.

use super::through_a_file;
use crate::common::*;

const DT: f64 = 1e-3;
const RATE: f64 = 0.4;

fn evenly(rate: f64) -> Option<GravityTurn> {
    Some(GravityTurn { course: TurnCourse::Rate { rate }, elapsed_secs: 0.0 })
}

/// ∫ g (sin Ωt, −cos Ωt) dt = g/Ω (1 − cos Ωt, −sin Ωt).
#[test]
fn what_falls_freely_goes_as_the_integral_of_gravity() {
    for &stepper in Stepper::ALL {
        let grain = Grain::at_rest(DVec2::ZERO, 0.1);
        let scene = Scene {
            stepper,
            gravity_turn: evenly(RATE),
            ..scene(Physics::FULL, -G * DVec2::Y, parameters(0.0, DT, 0.0, 0.5), vec![grain])
        };
        let mut run = start(&through_a_file(&scene));
        let mut work = 0.0;
        for _ in 0..2000 {
            work += run.step().expect("a finite state").gravity_work;
        }
        let angle = RATE * 2000.0 * DT;
        let expected = G / RATE * DVec2::new(1.0 - angle.cos(), -angle.sin());
        let grains = run.grains();
        // The middle of a step stands for the step: (ΩΔt)²/24.
        assert!(grains.velocities[0].distance(expected) < 2e-7, "{stepper}");
        let energy = 0.5 * grains.masses[0] * grains.velocities[0].length_squared();
        assert_close(work, energy, 1e-12, stepper.name());
        let Gravity::Uniform { acceleration } = run.world().gravity else { panic!("uniform") };
        assert_close(acceleration.length(), G, 1e-15, "g stays as large");
    }
}

/// Through a table of angles: a level is tilted to tan θ just below μ and then just above.
#[test]
fn a_disc_on_a_level_slides_once_gravity_leans_by_more_than_friction_holds() {
    let mu: f64 = 0.3;
    let [below, above] = [0.98, 1.02].map(|part| (part * mu).atan());
    let table = TurnCourse::Table {
        times_secs: vec![0.1, 0.4, 0.6, 0.7],
        angles: vec![0.0, below, below, above],
    };
    for (stepper, method) in every_way() {
        let grain = Grain::at_rest(DVec2::new(0.0, 0.1 * (1.0 - 1e-10)), 0.1);
        let mut scene = Scene {
            stepper,
            boundaries: vec![level()],
            gravity_turn: Some(GravityTurn { course: table.clone(), elapsed_secs: 0.0 }),
            ..scene(UNTURNING, -G * DVec2::Y, parameters(0.0, DT, 0.0, mu), vec![grain])
        };
        scene.solver.method = method;
        let mut run = after(&scene, 600);
        let what = format!("{stepper}, {method}");
        let speed = run.velocity(0).x;
        assert!(
            speed.abs() < if stepper == Stepper::Dem { 1e-4 } else { 1e-12 },
            "{what}: {speed}"
        );
        take_steps(&mut run, 1100);
        // g (sin θ − μ cos θ) since tan θ = μ, at 0.65 s: evenly rising until 0.7 s.
        let push = G * (above.sin() - mu * above.cos());
        let speed = run.velocity(0).x;
        assert_close(speed, push * (1.0 + 0.025), 5e-3, &what);
    }
}

#[test]
fn the_budget_of_energy_is_closed_under_gravity_that_turns() {
    for (stepper, method) in every_way_that_balances() {
        let mut scene = pressed_pile(40, 0.3, 5, parameters(2.0, DT, 0.3, 0.5));
        scene.gravity_turn = evenly(3.0);
        scene.solver.max_sweeps = 100;
        (scene.stepper, scene.solver.method) = (stepper, method);
        let mut run = start(&scene);
        let mut energy = run.observables().kinetic_energy;
        let mut scale = energy;
        for _ in 0..100 {
            let now = *run.step().expect("a finite state");
            let works = now.normal_work + now.tangential_work + now.gravity_work;
            scale += works.abs();
            let off = (now.kinetic_energy - energy - works).abs();
            assert!(off < 1e-10 * scale, "{stepper}, {method}: off by {off} J");
            energy = now.kinetic_energy;
        }
    }
}

#[test]
fn gravity_that_cannot_turn_so_is_refused() {
    let refused = |change: &dyn Fn(&mut Scene), expected: &str| {
        let grain = Grain::at_rest(DVec2::ZERO, 0.1);
        let mut scene = Scene {
            gravity_turn: evenly(RATE),
            ..scene(Physics::FULL, -G * DVec2::Y, parameters(0.0, DT, 0.0, 0.5), vec![grain])
        };
        change(&mut scene);
        let said = scene.simulation().map(|_| ()).expect_err("no such gravity").to_string();
        assert_eq!(said, expected);
    };
    refused(
        &|scene| scene.gravity = Gravity::Attraction { centre: DVec2::ZERO, magnitude: 1.0 },
        "gravity_turn is given, but must be left out where gravity is not uniform",
    );
    refused(
        &|scene| scene.physics = crate::common::LINE,
        "gravity_turn is given, but must be left out where physics.axes is 1",
    );
    refused(
        &|scene| scene.gravity_turn = evenly(f64::INFINITY),
        "gravity_turn.course.rate is inf, but must be finite",
    );
    let table = |times: [f64; 2], angles: [f64; 2]| {
        let course = TurnCourse::Table { times_secs: times.into(), angles: angles.into() };
        Some(GravityTurn { course, elapsed_secs: 0.0 })
    };
    refused(
        &|scene| scene.gravity_turn = table([1.0, 0.5], [0.0, 1.0]),
        "gravity_turn.course.times_secs[1] is 0.5, but must be finite, and above the time before it",
    );
    refused(
        &|scene| scene.gravity_turn = table([0.0, 0.5], [0.0, f64::NAN]),
        "gravity_turn.course.angles[1] is not finite, but must be finite",
    );
}
