//! Walls that move along their normal: what they do to grains, and that nothing depends on who moves.

use crate::common::*;
use slump::scene::stability::logs;

const RADIUS: f64 = 0.05;
const DT: f64 = 1e-3;
const SPEED: f64 = 0.2;

/// A wall along the y axis that comes from the left, from `distance` before the disc at the origin.
fn pushed(physics: Physics, restitution: f64, distance: f64, travel: f64) -> Scene {
    let grains = vec![Grain::at_rest(DVec2::ZERO, RADIUS)];
    let point = DVec2::new(-RADIUS - distance, 0.0);
    Scene {
        boundaries: vec![Boundary::Piston { point, normal: DVec2::X, speed: SPEED, travel }],
        ..scene(physics, DVec2::ZERO, parameters(0.0, DT, restitution, 0.5), grains)
    }
}

fn wall(run: &Simulation) -> f64 {
    match run.world().boundaries[0] {
        Boundary::Piston { point, .. } => point.x,
        _ => panic!("the wall is a piston"),
    }
}

#[test]
fn a_wall_hits_a_disc_at_rest_as_a_moving_disc_hits_a_wall() {
    for physics in [LINE, Physics::FULL] {
        for restitution in [0.0, 0.5, 1.0] {
            // From further than any list of near pairs reaches.
            let run = after(&pushed(physics, restitution, 20.0 * RADIUS, 10.0), 10_000);
            let expected = (1.0 + restitution) * SPEED;
            let speed = run.velocity(0).x;
            assert_close(speed, expected, 1e-12, "speed after the wall came");
        }
    }
}

#[test]
fn a_wall_goes_its_way_to_the_end_and_no_further_and_is_shown_where_it_is() {
    let travel = 10.3 * DT * SPEED;
    let mut run = start(&pushed(LINE, 0.0, 0.0, travel));
    let begin = wall(&run);
    take_steps(&mut run, 10);
    assert_close(wall(&run) - begin, 10.0 * DT * SPEED, 1e-12, "way in ten steps");
    take_steps(&mut run, 10);
    assert_close(wall(&run) - begin, travel, 1e-12, "way in the end");
    assert_eq!(run.snapshot().surroundings.boundaries, run.world().boundaries);
    assert!(run.place(0).x > travel, "the disc flies on");
}

/// A scene on a floor at rest, and as one sees it who sinks at [`SPEED`]: floor and grains rise.
fn two_views(scene: &Scene) -> [Scene; 2] {
    [0.0, SPEED].map(|speed| {
        let mut scene = scene.clone();
        let travel = f64::from(u32::MAX);
        let floor = Boundary::Piston { point: DVec2::ZERO, normal: DVec2::Y, speed, travel };
        scene.boundaries = vec![floor];
        scene.grains.iter_mut().for_each(|grain| grain.velocity.y += speed);
        scene
    })
}

/// Longest distance of a grain from where the other view has it in any step, in d.
fn difference_of_views(scene: &Scene) -> f64 {
    let [mut still, mut rising] = two_views(scene).map(|scene| start(&scene));
    let (mut furthest, mut landed) = (0f64, false);
    for _ in 0..150 {
        still.step().expect("a finite state");
        rising.step().expect("a finite state");
        let risen = DVec2::new(0.0, SPEED * still.time_secs());
        let [one, other] = [&still, &rising].map(|run| run.places());
        let ways = one.iter().zip(other).map(|(one, other)| (*one + risen).distance(*other));
        furthest = ways.fold(furthest, f64::max);
        landed |= still.place(3).y < 0.51 * scene.mean_diameter;
    }
    assert!(landed, "the disc that falls gets to the floor");
    furthest / scene.mean_diameter
}

#[test]
fn nothing_depends_on_whether_the_floor_rises_or_the_onlooker_sinks() {
    let mut scene = at_rest_and_falling();
    let mut differences = Vec::new();
    for (stepper, method) in every_way() {
        (scene.stepper, scene.solver.method) = (stepper, method);
        for push_out in [false, true] {
            if push_out && stepper != Stepper::Moreau {
                continue;
            }
            scene.remedies = Remedies { push_out, ..Remedies::default() };
            let off = difference_of_views(&scene);
            // A floor whose speed were forgotten in one step would be off by 0.02 d.
            if off > 1e-5 {
                differences.push((stepper, method, push_out, off));
            }
        }
    }
    assert!(differences.is_empty(), "{differences:?}");
}

#[test]
fn the_work_of_a_wall_is_in_the_balance_of_energy() {
    let mut scene = logs(1.0);
    scene.boundaries = vec![Boundary::Piston {
        point: DVec2::ZERO,
        normal: DVec2::Y,
        speed: SPEED,
        travel: 0.05 * SPEED,
    }];
    for (stepper, method) in every_way_that_balances() {
        (scene.stepper, scene.solver.method) = (stepper, method);
        let mut run = start(&scene);
        let (mut energy, mut work) = (0.0, 0.0);
        for _ in 0..100 {
            let now = *run.step().expect("a finite state");
            let change = now.kinetic_energy - energy;
            let works = now.normal_work + now.tangential_work + now.gravity_work;
            let off = (change - works).abs();
            assert!(off < 1e-12, "{stepper}, {method}: {change} by {works}");
            energy = now.kinetic_energy;
            work += now.normal_work;
        }
        assert!(work > 0.0, "{stepper}, {method}: the wall lifts");
    }
}

#[test]
fn a_grain_that_follows_a_wall_on_its_way_back_is_not_lost() {
    let mut scene = pushed(Physics::FULL, 0.0, 0.0, 10.0);
    scene.gravity = Gravity::Uniform { acceleration: DVec2::new(-9.8, 0.0) };
    if let Boundary::Piston { speed, .. } = &mut scene.boundaries[0] {
        *speed = -20.0 * SPEED;
    }
    let run = after(&scene, 1000);
    let place = run.place(0).x;
    assert!(place < -30.0 * RADIUS, "it falls after the wall, {place} m");
    let lost = |alarm: &Alarm| alarm.kind == AlarmKind::GrainLost;
    assert!(!run.alarms().iter().any(lost));
}

#[test]
fn a_wall_that_cannot_be_is_refused_with_its_field() {
    for (speed, travel) in [(f64::NAN, 1.0), (f64::INFINITY, 1.0), (1.0, -1.0), (1.0, f64::NAN)] {
        let mut scene = pushed(LINE, 0.0, 0.0, travel);
        if let Boundary::Piston { speed: of_wall, .. } = &mut scene.boundaries[0] {
            *of_wall = speed;
        }
        let said = scene.simulation().expect_err("no such wall").to_string();
        assert!(said.starts_with("boundaries[0] is speed"), "{said}");
    }
}

/// Each shock runs through the row and leaves its last ball not yet struck with 2V; in the end no
/// contact closes, and every ball has it.
#[test]
fn shocks_of_a_moving_wall_run_through_a_row_of_touching_balls() {
    for balls in 1..=4 {
        let place = |ball: usize| DVec2::new(2.0 * RADIUS * ball as f64, 0.0);
        let mut scene = pushed(LINE, 1.0, 0.0, 10.0);
        let row = (0..balls).map(|ball| Grain::at_rest(place(ball), RADIUS));
        scene.grains = row.collect();
        // Wherever rounding has put the last digit, they touch.
        scene.gap_tolerance = 1e-9;
        scene.remedies = Remedies { sequential_impacts: true, ..Remedies::default() };
        let run = after(&scene, 1);
        for velocity in run.velocities() {
            assert_close(velocity.x, 2.0 * SPEED, 1e-9, "speed after the wall came");
        }
    }
}
