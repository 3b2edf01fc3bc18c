//! Tests of cohesion whose force is Bond times a prescribed acceleration (`bond_acceleration`) times the effective
//! mass, so that cohesion acts without gravity.

use crate::common::*;

const RADIUS: f64 = 0.01;
const BOND: f64 = 20.0;

/// Returns a scene of two weightless discs that touch. One disc moves away from the other at 1 mm/s.
fn pulled_pair(stepper: Stepper, gravity: DVec2, bond_acceleration: f64) -> Scene {
    let at_rest = weightless(Grain::at_rest(DVec2::ZERO, RADIUS));
    let place = 2.0 * RADIUS * (1.0 - 1e-6) * DVec2::X;
    let pulled = weightless(moving(place, RADIUS, 1e-3 * DVec2::X));
    let parameters = Parameters { bond_acceleration, ..parameters(BOND, 1e-3, 0.0, 0.5) };
    let scene = scene(Physics::FULL, gravity, parameters, vec![at_rest, pulled]);
    Scene { stepper, solver: SolverSettings::default(), ..scene }
}

/// Runs 0.2 s and checks that each step is solved. Returns the speed at which the discs separate (m/s) and their gap
/// (in radii).
fn parted(scene: &Scene) -> [f64; 2] {
    let mut run = start(scene);
    for _ in 0..200 {
        assert!(run.step().expect("a finite state").converged, "{}", scene.stepper);
    }
    let grains = &run.world().grains;
    let speed = (grains.velocities[1] - grains.velocities[0]).x;
    [speed, (grains.positions[1] - grains.positions[0]).x / RADIUS - 2.0]
}

#[test]
fn a_bond_holds_without_gravity_where_its_force_has_an_acceleration() {
    let gravity = -G * DVec2::Y;
    for &stepper in Stepper::ALL {
        let [speed, distance] = parted(&pulled_pair(stepper, DVec2::ZERO, 0.0));
        assert!(speed > 0.99e-3 && distance > 0.01, "{stepper}: nothing holds, {speed} m/s");
        for held in [pulled_pair(stepper, DVec2::ZERO, G), pulled_pair(stepper, gravity, 0.0)] {
            let [speed, distance] = parted(&held);
            assert!(speed.abs() < 2e-5 && distance < 1e-3, "{stepper}: {speed} m/s, {distance}");
        }
    }
}

#[test]
fn an_acceleration_equal_to_gravity_changes_no_bit_and_a_larger_one_is_a_larger_bond() {
    for &stepper in Stepper::ALL {
        let run = |bond: f64, bond_acceleration: f64| {
            let mut scene = pressed_pile(20, 0.3, 5, parameters(bond, 1e-3, 0.1, 0.5));
            scene.stepper = stepper;
            scene.parameters.bond_acceleration = bond_acceleration;
            let mut run = start(&scene);
            take_steps(&mut run, 20);
            (bits(&run), run.fracture_work(), run.observables().bond_energy)
        };
        assert_eq!(run(BOND, G), run(BOND, 0.0), "{stepper}");
        assert_ne!(run(BOND, 2.0 * G), run(BOND, 0.0), "{stepper}");
        assert_eq!(run(BOND, 2.0 * G), run(2.0 * BOND, 0.0), "{stepper}");
    }
}

#[test]
fn numbers_of_cohesion_go_by_its_acceleration() {
    let gravity = 0.0;
    let free = Parameters { bond_acceleration: 4.0, ..parameters(BOND, 1e-3, 0.0, 0.5) };
    assert_close(free.capture_speed(gravity), 20.0 * 4.0 * 1e-3, 1e-15, "capture speed");
    // The speed that scales the cohesive time is √(a d) without gravity (a: acceleration of cohesion), and √(g d) with
    // gravity.
    let cohesive_time = free.capture_speed(gravity) / (4.0 * 0.01f64).sqrt();
    assert_close(free.cohesive_time(0.01, gravity), cohesive_time, 1e-14, "without gravity");
    let cohesive_time = free.capture_speed(G) / (G * 0.01f64).sqrt();
    assert_close(free.cohesive_time(0.01, G), cohesive_time, 1e-14, "with gravity");

    let work = |acceleration: f64, gravity: DVec2| {
        let run = start(&pulled_pair(Stepper::Range, gravity, acceleration));
        run.fracture_work().expect("a law with a work").joules
    };
    assert_close(work(G, DVec2::ZERO), work(0.0, -G * DVec2::Y), 1e-14, "work of fracture");
    assert_eq!(work(0.0, DVec2::ZERO), 0.0);
}
