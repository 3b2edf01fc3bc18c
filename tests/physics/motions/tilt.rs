//! Gravity that is tilted by hand: a tilted world is the one whose gravity is listed so, a tilt may change between any
//! two steps, and a run that is saved knows of it.

use super::saved_and_read;
use crate::common::*;

/// What rests, falls and is bonded, on a floor.
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

fn places(run: &Simulation) -> Vec<[u64; 2]> {
    let positions = run.places().iter();
    positions.map(|place| place.to_array().map(f64::to_bits)).collect()
}

fn step(run: &mut Simulation, steps: u64) {
    run.take_steps(steps).expect("finite states");
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
            step(run, 30);
        }
        assert_eq!(places(&one), places(&other), "{stepper}, {method}");
        assert_ne!(places(&one), places(&level), "{stepper}, {method}");
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
    let expected = DVec2::new(0.5 * g, -(0.75f64.sqrt()) * g);
    assert!(gravity(&run).distance(expected) < 1e-12 * g);
    settings.parameters.tilt = 0.0;
    run.change(settings).expect("sound settings");
    step(&mut run, 20);
    let mut level = start(&on_a_floor());
    step(&mut level, 20);
    assert_eq!(places(&run), places(&level));
}

#[test]
fn a_run_that_is_tilted_on_the_way_goes_on_from_its_file_bit_for_bit() {
    for scene in ["incline", "pile"].map(|name| built_in(name).expect("a scene")) {
        let mut simulation = start(&scene);
        step(&mut simulation, 5);
        let mut settings = *simulation.settings();
        settings.parameters.tilt = -12.5;
        simulation.change(settings).expect("sound settings");
        step(&mut simulation, 5);
        let read = saved_and_read(&scene, &simulation);
        let mut again = read.simulation.clone();
        for run in [&mut simulation, &mut again] {
            step(run, 10);
        }
        assert_eq!(places(&simulation), places(&again));
        // A new start from there has the scene's own turn, and the tilt as a setting.
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
        step(run, 20);
    }
    let [one, other] = [&sum, &whole].map(|run| run.places());
    let apart = one.iter().zip(other).map(|(one, other)| one.distance(*other)).fold(0.0, f64::max);
    assert!(apart < 1e-12, "{apart} m");
}

#[test]
fn what_has_no_direction_is_not_tilted() {
    let cradle = tilted(&built_in("cradle").expect("a scene"), 5.0);
    let refused = cradle.validate().expect_err("no direction").to_string();
    assert_eq!(refused, "tilt is 5, but must be left out or 0 where gravity is not uniform");
    let refused = tilted(&on_a_floor(), 200.0).validate().expect_err("too far").to_string();
    assert_eq!(refused, "tilt is 200, but must be between -180 and 180 degrees");
}
