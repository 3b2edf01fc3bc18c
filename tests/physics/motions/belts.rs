//! A disc that is laid on a surface which slides away under it. Coulomb's friction pulls it along with μg until it
//! goes with the surface. With V the speed of that, a disc that cannot turn then has v = V. One that can has
//! v = μgt and rω = 2μgt as long as it slips, as it does until v + rω = V: from then on it rolls with v = V/3.

use super::through_a_file;
use crate::common::*;

const RADIUS: f64 = 0.1;
const MU: f64 = 0.25;
const DT: f64 = 1e-3;
const SPEED: f64 = 0.6;

/// A level whose surface goes to the right with [`SPEED`], by every shape and motion that can say it.
fn belts() -> Vec<(&'static str, Boundary, Motion)> {
    let at = |x: f64| DVec2::new(x, 0.0);
    let low = |x: f64| DVec2::new(x, -1.0);
    let segment = || Boundary::Segment { from: at(-1.0), to: at(3.0) };
    let polygon = Boundary::ConvexPolygon { points: vec![low(-1.0), low(3.0), at(3.0), at(-1.0)] };
    let along = || goes(&[0], straight(DVec2::new(SPEED, 0.0)));
    // The normal turned by +90° points to the left.
    let round = || belt(&[0], -SPEED);
    vec![
        ("half-space", level(), along()),
        ("belt", level(), round()),
        ("segment", segment(), along()),
        ("belt of a segment", segment(), round()),
        ("polyline", Boundary::Polyline { points: [-1.0, 0.5, 3.0].map(at).to_vec() }, along()),
        ("belt of a polygon", polygon, round()),
    ]
}

fn on_belt(physics: Physics, boundary: Boundary, motion: Motion) -> Scene {
    let grain = Grain::at_rest(DVec2::new(0.0, RADIUS * (1.0 - 1e-10)), RADIUS);
    Scene {
        boundaries: vec![boundary],
        motions: vec![motion],
        ..scene(physics, -G * DVec2::Y, parameters(0.0, DT, 0.0, MU), vec![grain])
    }
}

#[test]
fn a_disc_on_a_belt_is_pulled_along_by_friction_until_it_goes_with_it() {
    for (name, boundary, motion) in belts() {
        for (physics, end) in [(UNTURNING, SPEED), (Physics::FULL, SPEED / 3.0)] {
            let mut scene = on_belt(physics, boundary.clone(), motion.clone());
            for (stepper, method) in every_way_that_balances() {
                (scene.stepper, scene.solver.method) = (stepper, method);
                let what = format!("{name}, {stepper}, {method}");
                let mut run = start(&through_a_file(&scene));
                let slipping = (0.5 * end / (MU * G * DT)) as usize;
                take_steps(&mut run, slipping);
                let speed = run.velocity(0).x;
                let expected = MU * G * DT * slipping as f64;
                // The springs of the smooth method have not settled yet.
                let tolerance = if stepper == Stepper::Dem { 0.1 } else { 1e-9 };
                assert_close(speed, expected, tolerance, &what);
                let mut of_walls = 0.0;
                let mut run = start(&scene);
                for _ in 0..1500 {
                    of_walls += run.step().expect("a finite state").wall_work;
                }
                let grains = run.grains();
                assert_close(grains.velocities[0].x, end, 1e-9, &what);
                let spin = RADIUS * grains.angular_velocities[0];
                assert!((spin - (SPEED - end)).abs() < 1e-9, "{what}: rω {spin}");
                // All that the belt gave went by friction, whose impulse is mv, at the speed of the belt.
                let expected = grains.masses[0] * end * SPEED;
                assert_close(of_walls, expected, 1e-9, &what);
            }
        }
    }
}

#[test]
fn models_of_friction_see_the_belt() {
    for model in [FrictionModel::Tresca, FrictionModel::Desaxce] {
        for method in [Method::Nsgs, Method::InteriorPoint] {
            let mut scene = on_belt(Physics::FULL, level(), belt(&[0], -SPEED));
            (scene.solver.friction_model, scene.solver.method) = (model, method);
            scene.solver.model_solves = 4;
            scene.solver.tolerance = 1e-9;
            let run = after(&scene, 400);
            let speed = run.velocity(0).x;
            assert_close(speed, SPEED / 3.0, 1e-3, &format!("{model}, {method}"));
        }
    }
}

#[test]
fn a_belt_goes_round_a_segment_and_a_disc_that_turns_is_a_belt() {
    let segment = Boundary::Segment { from: DVec2::new(-1.0, 0.0), to: DVec2::new(1.0, 0.0) };
    for upside_down in [false, true] {
        let sign = if upside_down { -1.0 } else { 1.0 };
        let mut scene = on_belt(UNTURNING, segment.clone(), belt(&[0], SPEED));
        scene.grains[0].position.y *= sign;
        scene.gravity = Gravity::Uniform { acceleration: DVec2::new(0.0, -G * sign) };
        let simulation = after(&scene, 50);
        let speed = simulation.velocity(0).x;
        assert_close(
            speed,
            -sign * MU * G * 50.0 * DT,
            1e-9,
            "to the left above, to the right below",
        );
    }
    let large = 2.0;
    let disc = |motion: Motion| {
        let mut scene = on_belt(Physics::FULL, level(), motion);
        scene.boundaries.clear();
        scene.fixed_discs = vec![crate::common::fixed(DVec2::new(0.0, -large), large)];
        start(&scene)
    };
    let turning = MotionCourse::Rotation {
        pivot: DVec2::new(0.0, -large),
        rate: SPEED / large,
        travel: None,
    };
    let of_disc = Motion { fixed_discs: vec![0], ..Motion::default() };
    let mut turns = disc(Motion { course: Some(turning), ..of_disc.clone() });
    let mut goes_round = disc(Motion { surface_speed: SPEED, ..of_disc });
    take_steps(&mut turns, 100);
    take_steps(&mut goes_round, 100);
    let [one, other] = [&turns, &goes_round].map(|run| run.place(0));
    assert!(one.x < -0.01, "it was pulled along: {one}");
    assert!(one.distance(other) < 1e-9, "{one} and {other}");
}
