//! Bodies that turn: a drum, and what falls out of it.

use crate::common::*;

const MU: f64 = 0.5;

/// A drum of so many sides about the origin.
fn drum(radius: f64, sides: usize) -> Boundary {
    let corner = |k: usize| {
        let angle = std::f64::consts::TAU * ((k % sides) as f64 + 0.5) / sides as f64;
        radius * DVec2::from_angle(angle)
    };
    Boundary::Polyline { points: (0..=sides).map(corner).collect() }
}

fn turns(rate: f64) -> MotionCourse {
    MotionCourse::Rotation { pivot: DVec2::ZERO, rate, travel: None }
}

/// A disc that cannot turn sticks to the wall and goes with the point that it touches: with ΩR/(R − r) about the axis,
/// until tan φ = μ. From there on it slides, as a pendulum about that angle would swing: the friction that draws it on
/// does not change with the slip.
#[test]
fn a_disc_in_a_drum_goes_with_the_wall_until_friction_holds_it_no_more() {
    let (outer, radius, rate) = (1.0, 0.1, 0.2);
    for stepper in Stepper::ALL {
        let place = DVec2::new(0.0, -(outer - radius) + 1e-6);
        let scene = Scene {
            stepper: *stepper,
            boundaries: vec![drum(outer, 2000)],
            motions: vec![goes(&[0], turns(rate))],
            ..scene(
                UNTURNING,
                -G * DVec2::Y,
                parameters(0.0, 1e-3, 0.0, MU),
                vec![Grain::at_rest(place, radius)],
            )
        };
        let mut run = start(&scene);
        let angle = |run: &Simulation| {
            let place = run.place(0);
            place.x.atan2(-place.y)
        };
        take_steps(&mut run, 500);
        let first = angle(&run);
        take_steps(&mut run, 1000);
        let gone = angle(&run) - first;
        // Corners of the drum turn the normal by 2π/2000, which a step meets late.
        assert_close(gone, rate * outer / (outer - radius), 1e-2, stepper.name());
        take_steps(&mut run, 1500);
        let (mut least, mut most) = (f64::INFINITY, 0f64);
        for _ in 0..2500 {
            take_steps(&mut run, 1);
            (least, most) = (least.min(angle(&run)), most.max(angle(&run)));
        }
        assert_close(0.5 * (least + most), MU.atan(), 1e-2, stepper.name());
        // No faster than the wall, at √(g/(R − r)·√(1 + μ²)).
        let swing = rate * outer / (outer - radius) / (G * MU.hypot(1.0) / (outer - radius)).sqrt();
        assert!(most - least < 2.1 * swing, "{stepper}: {least} to {most}");
    }
}

/// Grains in a drum over a turn: none gets out, and the drum shows where it is.
#[test]
fn a_drum_keeps_its_grains_and_one_that_is_cut_open_loses_them() {
    let mut random = random(4);
    let (outer, rate) = (0.1, 6.0);
    let grains: Vec<Grain> = (0..60)
        .map(|k| {
            let radius = 4e-3 * random.random_range(0.8..1.2);
            let (row, column) = (k / 10, k % 10);
            let place = DVec2::new(f64::from(column) - 4.5, f64::from(row) - 5.5);
            Grain::at_rest(0.0105 * place, radius)
        })
        .collect();
    for stepper in Stepper::ALL {
        let mut scene = Scene {
            stepper: *stepper,
            boundaries: vec![drum(outer, 40)],
            motions: vec![goes(&[0], turns(rate))],
            ..scene(Physics::FULL, -G * DVec2::Y, parameters(0.0, 1e-3, 0.1, MU), grains.clone())
        };
        scene.solver.max_sweeps = 50;
        scene.solver.tolerance = 1e-4;
        let run = after(&scene, 1100);
        let farthest = run.places().iter().map(|place| place.length());
        let farthest = farthest.fold(0.0, f64::max);
        assert!(farthest < outer, "{stepper}: {farthest} m from the axis");
        assert_eq!(run.observables().lost_grains, 0, "{stepper}");
        let Boundary::Polyline { points } = &run.world().boundaries[0] else {
            panic!("a polyline")
        };
        let Boundary::Polyline { points: begin } = drum(outer, 40) else { panic!("a polyline") };
        let turned = begin[7].angle_to(points[7]).rem_euclid(std::f64::consts::TAU);
        assert_close(turned, (rate * 1.1).rem_euclid(std::f64::consts::TAU), 1e-9, "angle");
        assert_eq!(run.snapshot().surroundings.boundaries, run.world().boundaries);
    }
}

/// A wall that rises under grains passes none of them; one that jumps over a grain has.
#[test]
fn a_grain_is_lost_where_a_wall_passes_it_and_not_where_it_rides_on_it() {
    let floor = Boundary::Segment { from: DVec2::new(-1.0, 0.0), to: DVec2::new(1.0, 0.0) };
    for (speed, lost) in [(0.5, 0), (-0.5, 0), (200.0, 1)] {
        let grain = Grain::at_rest(DVec2::new(0.1, 0.05), 0.05);
        let mut scene = Scene {
            boundaries: vec![floor.clone()],
            motions: vec![goes(&[0], straight(speed * DVec2::Y))],
            ..scene(Physics::FULL, -G * DVec2::Y, parameters(0.0, 1e-3, 0.0, MU), vec![grain])
        };
        scene.duration_secs = 2.0;
        let run = after(&scene, if lost == 1 { 1 } else { 1000 });
        assert_eq!(run.observables().lost_grains, lost, "{speed} m/s");
    }
}

/// Fixed discs far outside of any list of near pairs come to a grain and push it before them.
#[test]
fn discs_that_move_are_found_wherever_they_come_to() {
    for stepper in Stepper::ALL {
        let grain = Grain { feels_gravity: false, ..Grain::at_rest(DVec2::ZERO, 0.05) };
        let travel = Some(2.0);
        let course = MotionCourse::Straight { direction: DVec2::X, speed: 1.0, travel };
        let mut scene = Scene {
            stepper: *stepper,
            motions: vec![Motion {
                fixed_discs: vec![0],
                course: Some(course),
                ..Motion::default()
            }],
            ..scene(Physics::FULL, -G * DVec2::Y, parameters(0.0, 1e-3, 0.0, MU), vec![grain])
        };
        scene.fixed_discs = vec![fixed(DVec2::new(-1.5, 0.0), 0.05)];
        let run = after(&scene, 2500);
        let disc = run.world().fixed_discs[0].position;
        assert_close(disc.x, 0.5, 1e-12, "the disc has gone its way and stays");
        assert_eq!(run.snapshot().surroundings.fixed_discs, run.world().fixed_discs);
        let speed = run.velocity(0).x;
        let tolerance = match stepper {
            Stepper::Dem | Stepper::Avbd => 0.05,
            _ => 1e-9,
        };
        assert_close(speed, 1.0, tolerance, stepper.name());
    }
}
