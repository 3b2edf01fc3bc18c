//! Tests of gravity whose direction turns with time or is tilted by the user: free fall, sliding, and equality of a
//! tilted scene with a scene whose gravity is defined in the tilted direction.

use super::{saved_and_read, through_a_file};
use crate::common::*;

const DT: f64 = 1e-3;
const RATE: f64 = 0.4;

fn evenly(rate: f64) -> Option<GravityTurn> {
    Some(GravityTurn { course: TurnCourse::Rate { rate }, elapsed_secs: 0.0 })
}

/// Checks free fall under gravity whose direction turns at the angular velocity Ω. If g is the magnitude of gravity,
/// the velocity at the time t must be ∫ g (sin Ωt, −cos Ωt) dt = g/Ω (1 − cos Ωt, −sin Ωt).
#[test]
fn what_falls_freely_goes_as_the_integral_of_gravity() {
    for &stepper in Stepper::ALL {
        let grain = Grain::at_rest(DVec2::ZERO, 0.1);
        let scene = Scene {
            stepper,
            gravity_turn: evenly(RATE),
            ..under_g(parameters(0.0, DT, 0.0, 0.5), vec![grain])
        };
        let mut run = start(&through_a_file(&scene));
        let mut work = 0.0;
        for _ in 0..2000 {
            work += run.step().expect("a finite state").gravity_work;
        }
        let angle = RATE * 2000.0 * DT;
        let expected = G / RATE * DVec2::new(1.0 - angle.cos(), -angle.sin());
        let grains = run.grains();
        // A step uses the gravity at its middle, which gives the relative error (ΩΔt)²/24.
        assert!(grains.velocities[0].distance(expected) < 2e-7, "{stepper}");
        let energy = 0.5 * grains.masses[0] * grains.velocities[0].length_squared();
        assert_close(work, energy, 1e-12, stepper.name());
        let Gravity::Uniform { acceleration } = run.world().gravity else { panic!("uniform") };
        assert_close(acceleration.length(), G, 1e-15, "g stays as large");
    }
}

/// Checks that a disc on a level floor sticks while gravity is inclined by an angle θ with tan θ just below the
/// friction coefficient μ, and slides when tan θ is just above μ. A table of angles over time defines the direction of
/// gravity.
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
        // The acceleration g (sin θ − μ cos θ) reaches 0 at 0.65 s, when tan θ = μ, and then rises linearly until 0.7
        // s.
        let push = G * (above.sin() - mu * above.cos());
        assert_close(run.velocity(0).x, push * (1.0 + 0.025), 5e-3, &what);
    }
}

/// Returns a scene of grains on a floor: some rest, one falls, and one is attached to the floor by a bond.
fn on_a_floor() -> Scene {
    let mut scene = at_rest_and_falling();
    scene.boundaries = vec![level()];
    scene
}

fn tilted(scene: &Scene, degrees: f64) -> Scene {
    let mut tilted = scene.clone();
    tilted.parameters.tilt = degrees;
    tilted
}

#[test]
fn a_tilted_world_is_bit_for_bit_the_one_whose_gravity_is_listed_so() {
    let Gravity::Uniform { acceleration } = on_a_floor().gravity else { panic!("not uniform") };
    for (stepper, method) in every_way() {
        let mut scene = on_a_floor();
        (scene.stepper, scene.solver.method) = (stepper, method);
        let mut listed = scene.clone();
        let turn = DVec2::from_angle(20f64.to_radians());
        listed.gravity = Gravity::Uniform { acceleration: turn.rotate(acceleration) };
        let [mut one, mut other, mut level] = [&tilted(&scene, 20.0), &listed, &scene].map(start);
        assert_eq!(one.observables().potential_energy, other.observables().potential_energy);
        for run in [&mut one, &mut other, &mut level] {
            take_steps(run, 30);
        }
        assert_eq!(bits(&one), bits(&other), "{stepper}, {method}");
        assert_ne!(bits(&one), bits(&level), "{stepper}, {method}");
    }
}

#[test]
fn gravity_points_to_the_right_where_the_tilt_is_above_0_and_comes_back() {
    let mut run = start(&on_a_floor());
    let mut settings = *run.settings();
    settings.parameters.tilt = 30.0;
    run.change(settings).expect("sound settings");
    let gravity = |run: &Simulation| run.world().gravity.acceleration(DVec2::ZERO);
    let g = gravity(&start(&on_a_floor())).length();
    assert!(gravity(&run).distance(DVec2::new(0.5 * g, -(0.75f64.sqrt()) * g)) < 1e-12 * g);
    settings.parameters.tilt = 0.0;
    run.change(settings).expect("sound settings");
    take_steps(&mut run, 20);
    let mut level = start(&on_a_floor());
    take_steps(&mut level, 20);
    assert_eq!(bits(&run), bits(&level));
}

#[test]
fn a_run_that_is_tilted_on_the_way_goes_on_from_its_file_bit_for_bit() {
    for scene in ["incline", "pile"].map(|name| built_in(name).expect("a scene")) {
        let mut simulation = start(&scene);
        take_steps(&mut simulation, 5);
        let mut settings = *simulation.settings();
        settings.parameters.tilt = -12.5;
        simulation.change(settings).expect("sound settings");
        take_steps(&mut simulation, 5);
        let read = saved_and_read(&scene, &simulation);
        let mut again = read.simulation.clone();
        for run in [&mut simulation, &mut again] {
            take_steps(run, 10);
        }
        assert_eq!(bits(&simulation), bits(&again));
        // An initial state made from the saved state has the turning gravity of the scene itself and the tilt as a
        // setting.
        let start = read.as_start();
        assert_eq!(start.parameters.tilt, -12.5);
        assert_eq!(start.gravity, read.scene.gravity);
        assert_eq!(start.gravity_turn.is_some(), read.scene.gravity_turn.is_some());
    }
}

#[test]
fn a_tilt_adds_to_what_turns_by_itself() {
    let mut scene = on_a_floor();
    let turn = |angle: f64| {
        let course = TurnCourse::Table { times_secs: vec![0.0], angles: vec![angle] };
        Some(GravityTurn { course, elapsed_secs: 0.0 })
    };
    scene.gravity_turn = turn(0.25);
    let mut sum = start(&tilted(&scene, 0.5f64.to_degrees()));
    scene.gravity_turn = turn(0.75);
    let mut whole = start(&scene);
    for run in [&mut sum, &mut whole] {
        take_steps(run, 20);
    }
    let [one, other] = [&sum, &whole].map(|run| run.places());
    let apart = one.iter().zip(other).map(|(one, other)| one.distance(*other)).fold(0.0, f64::max);
    assert!(apart < 1e-12, "{apart} m");
}
