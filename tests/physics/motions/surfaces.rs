//! Tests of moving surfaces: drums, shaken floors, and a disc that is laid on a sliding surface.
//!
//! The disc has the radius r, its velocity is v, and the surface moves at the speed V. Coulomb friction (coefficient μ)
//! accelerates the disc with μg (g: gravitational acceleration) until it moves with the surface. A disc that cannot
//! rotate then has v = V. A disc that can rotate slips at first: at the time t it has v = μgt and rω = 2μgt (ω: angular
//! velocity), until v + rω = V. Then it rolls with v = V/3.

use super::through_a_file;
use crate::common::*;

const RADIUS: f64 = 0.1;
const MU: f64 = 0.25;
const DT: f64 = 1e-3;
const SPEED: f64 = 0.6;

/// Returns floors whose surface moves to the right at [`SPEED`], with their names: one floor for each possible
/// combination of a shape (half-space, segment, polyline, polygon) and a motion. The body moves to the right, or it is
/// at rest and only its surface moves like a belt.
fn belts() -> Vec<(&'static str, Boundary, Motion)> {
    let at = |x: f64| DVec2::new(x, 0.0);
    let low = |x: f64| DVec2::new(x, -1.0);
    let segment = || Boundary::Segment { from: at(-1.0), to: at(3.0) };
    let polygon = Boundary::ConvexPolygon { points: vec![low(-1.0), low(3.0), at(3.0), at(-1.0)] };
    let along = || goes(&[0], straight(DVec2::new(SPEED, 0.0)));
    // A positive surface speed is along the normal turned by +90°, which points to the left.
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
    for ((name, boundary, motion), (physics, end)) in
        pairs(belts(), [(UNTURNING, SPEED), (Physics::FULL, SPEED / 3.0)])
    {
        let mut scene = on_belt(physics, boundary.clone(), motion.clone());
        for (stepper, method) in every_way_that_balances() {
            (scene.stepper, scene.solver.method) = (stepper, method);
            let what = format!("{name}, {stepper}, {method}");
            let mut run = start(&through_a_file(&scene));
            let slipping = (0.5 * end / (MU * G * DT)) as usize;
            take_steps(&mut run, slipping);
            let speed = run.velocity(0).x;
            let expected = MU * G * DT * slipping as f64;
            // Under `dem` the springs have not settled yet.
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
            // The belt does its work only by friction: the impulse mv on the disc times the speed of the belt.
            let expected = grains.masses[0] * end * SPEED;
            assert_close(of_walls, expected, 1e-9, &what);
        }
    }
}

#[test]
fn models_of_friction_see_the_belt() {
    for (model, method) in pairs(
        [FrictionModel::Tresca, FrictionModel::Desaxce],
        [Method::Nsgs, Method::InteriorPoint],
    ) {
        let mut scene = on_belt(Physics::FULL, level(), belt(&[0], -SPEED));
        (scene.solver.friction_model, scene.solver.method) = (model, method);
        scene.solver.model_solves = 4;
        scene.solver.tolerance = 1e-9;
        let run = after(&scene, 400);
        assert_close(run.velocity(0).x, SPEED / 3.0, 1e-3, &format!("{model}, {method}"));
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
        let expected = -sign * MU * G * 50.0 * DT;
        let speed = after(&scene, 50).velocity(0).x;
        assert_close(speed, expected, 1e-9, "to the left above, to the right below");
    }
    let large = 2.0;
    let disc = |motion: Motion| {
        let mut scene = on_belt(Physics::FULL, level(), motion);
        scene.boundaries.clear();
        scene.fixed_discs = vec![fixed(DVec2::new(0.0, -large), large)];
        after(&scene, 100)
    };
    let turns = disc(discs_go(1, round(DVec2::new(0.0, -large), SPEED / large)));
    let goes_round =
        disc(Motion { fixed_discs: vec![0], surface_speed: SPEED, ..Motion::default() });
    let [one, other] = [&turns, &goes_round].map(|run| run.place(0));
    assert!(one.x < -0.01, "it was pulled along: {one}");
    // The velocity of a belt is defined at the surface of the fixed disc, but the velocity of a turning body is taken
    // at the surface of the grain, across the gap.
    assert!(one.distance(other) < 1e-8, "{one} and {other}");
}

const MU_OF_DRUM: f64 = 0.5;

/// Returns a regular polygon about the origin, as the wall of a drum (radius in m).
fn drum(radius: f64, sides: usize) -> Boundary {
    let corner = |k: usize| {
        let angle = std::f64::consts::TAU * ((k % sides) as f64 + 0.5) / sides as f64;
        radius * DVec2::from_angle(angle)
    };
    Boundary::Polyline { points: (0..=sides).map(corner).collect() }
}

/// Checks a disc of radius r, which cannot rotate, in a drum of radius R that turns at the angular velocity Ω. The disc
/// sticks to the wall and moves about the axis at ΩR/(R − r) until tan φ = μ, where φ is its angle from the lowest
/// point and μ the friction coefficient. From then on it slides and swings like a pendulum about the angle φ = atan μ,
/// because friction does not depend on the sliding speed.
#[test]
fn a_disc_in_a_drum_goes_with_the_wall_until_friction_holds_it_no_more() {
    let (outer, radius, rate) = (1.0, 0.1, 0.2);
    for &stepper in Stepper::ALL {
        let place = DVec2::new(0.0, -(outer - radius) + 1e-6);
        let scene = Scene {
            stepper,
            boundaries: vec![drum(outer, 2000)],
            motions: vec![goes(&[0], round(DVec2::ZERO, rate))],
            ..scene(
                UNTURNING,
                -G * DVec2::Y,
                parameters(0.0, 1e-3, 0.0, MU_OF_DRUM),
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
        // At each corner of the drum the normal turns by 2π/2000. A step notices this late.
        assert_close(gone, rate * outer / (outer - radius), 1e-2, stepper.name());
        take_steps(&mut run, 1500);
        let (mut least, mut most) = (f64::INFINITY, 0f64);
        for _ in 0..2500 {
            take_steps(&mut run, 1);
            (least, most) = (least.min(angle(&run)), most.max(angle(&run)));
        }
        assert_close(0.5 * (least + most), MU_OF_DRUM.atan(), 1e-2, stepper.name());
        // The disc is never faster than the wall, and swings at the angular frequency √(g/(R − r)·√(1 + μ²)). This
        // limits its amplitude.
        let swing =
            rate * outer / (outer - radius) / (G * MU_OF_DRUM.hypot(1.0) / (outer - radius)).sqrt();
        assert!(most - least < 2.1 * swing, "{stepper}: {least} to {most}");
    }
}

/// Checks that a closed drum keeps all grains inside during one turn, and that its boundary has then turned by the
/// right angle.
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
    for &stepper in Stepper::ALL {
        let mut scene = Scene {
            stepper,
            boundaries: vec![drum(outer, 40)],
            motions: vec![goes(&[0], round(DVec2::ZERO, rate))],
            ..under_g(parameters(0.0, 1e-3, 0.1, MU_OF_DRUM), grains.clone())
        };
        scene.solver.max_sweeps = 50;
        scene.solver.tolerance = 1e-4;
        let run = after(&scene, 1100);
        let far = run.places().iter().map(|place| place.length()).fold(0.0, f64::max);
        assert!(far < outer, "{stepper}: {far} m from the axis");
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

/// Checks which grains Slump counts as lost, which means that they have passed through a wall. A grain that is carried
/// by a moving wall is not lost. A grain is lost if a wall moves past it within one step.
#[test]
fn a_grain_is_lost_where_a_wall_passes_it_and_not_where_it_rides_on_it() {
    let floor = Boundary::Segment { from: DVec2::new(-1.0, 0.0), to: DVec2::new(1.0, 0.0) };
    for (speed, lost) in [(0.5, 0), (-0.5, 0), (200.0, 1)] {
        // The initial gap is larger than the touch tolerance, because a wall carries every grain that touches it, at
        // any speed.
        let grain = Grain::at_rest(DVec2::new(0.1, 0.05001), 0.05);
        let mut scene = Scene {
            boundaries: vec![floor.clone()],
            motions: vec![goes(&[0], straight(speed * DVec2::Y))],
            ..under_g(parameters(0.0, 1e-3, 0.0, MU_OF_DRUM), vec![grain])
        };
        scene.duration_secs = 2.0;
        let run = after(&scene, if lost == 1 { 1 } else { 1000 });
        assert_eq!(run.observables().lost_grains, lost, "{speed} m/s");
    }
}

/// Checks that a moving disc (not a grain) pushes a grain that it reaches. The disc starts so far away that no list of
/// near pairs contains it.
#[test]
fn discs_that_move_are_found_wherever_they_come_to() {
    for &stepper in Stepper::ALL {
        let grain = weightless(Grain::at_rest(DVec2::ZERO, 0.05));
        let travel = Some(2.0);
        let course = MotionCourse::Straight { direction: DVec2::X, speed: 1.0, travel };
        let mut scene = Scene {
            stepper,
            motions: vec![discs_go(1, course)],
            ..under_g(parameters(0.0, 1e-3, 0.0, MU_OF_DRUM), vec![grain])
        };
        scene.fixed_discs = vec![fixed(DVec2::new(-1.5, 0.0), 0.05)];
        let run = after(&scene, 2500);
        let disc = run.world().fixed_discs[0].position;
        assert_close(disc.x, 0.5, 1e-12, "the disc has gone its way and stays");
        assert_eq!(run.snapshot().surroundings.fixed_discs, run.world().fixed_discs);
        let speed = run.velocity(0).x;
        let is_soft = [Stepper::Dem, Stepper::Avbd].contains(&stepper);
        let tolerance = if is_soft { 0.05 } else { 1e-9 };
        assert_close(speed, 1.0, tolerance, stepper.name());
    }
}

/// Returns a scene of a pile on a base that shakes in both directions, next to a belt and a wall that moves obliquely.
fn shaken() -> Scene {
    let mut scene = pressed_pile(40, 0.3, 5, parameters(2.0, 1e-3, 0.3, 0.5));
    let amplitude = DVec2::new(1e-3, 1e-3);
    let shaken = MotionCourse::Sine { amplitude, frequency_hz: 20.0, phase: 0.0 };
    scene.boundaries = vec![
        level(),
        plane(-0.017 * DVec2::X, DVec2::X),
        Boundary::Segment { from: DVec2::new(0.02, -1.0), to: DVec2::new(0.02, 1.0) },
    ];
    let discs = (0..scene.fixed_discs.len()).collect();
    scene.motions = vec![
        Motion { fixed_discs: discs, ..goes(&[0], shaken) },
        goes(&[1], straight(DVec2::new(0.05, -0.3))),
        belt(&[2], 0.4),
    ];
    scene.solver.max_sweeps = 100;
    scene
}

#[test]
fn the_budget_of_energy_is_closed_where_walls_move_and_where_gravity_turns() {
    let mut turning = pressed_pile(40, 0.3, 5, parameters(2.0, 1e-3, 0.3, 0.5));
    let course = TurnCourse::Rate { rate: 3.0 };
    turning.gravity_turn = Some(GravityTurn { course, elapsed_secs: 0.0 });
    turning.solver.max_sweeps = 100;
    let mut lifted = slump::scene::stability::logs(1.0);
    lifted.boundaries = vec![piston(DVec2::ZERO, DVec2::Y, 0.2, 0.01)];
    for (name, scene, allowed) in
        [("shaken", shaken(), 1e-11), ("turning", turning, 1e-10), ("lifted", lifted, 1e-10)]
    {
        for (way, scene) in in_each_way(&scene, every_way_that_balances()) {
            let mut run = start(&scene);
            let (mut scale, mut of_walls) = (run.observables().kinetic_energy, 0.0);
            for _ in 0..100 {
                let (now, off, _) = balance(&mut run);
                scale += (now.normal_work + now.tangential_work + now.gravity_work).abs();
                // A method that has not converged leaves large impulses on wedged grains. These impulses cancel each
                // other, but their rounding errors do not.
                let impulses = run.contacts().impulses().iter();
                let rounding: f64 = impulses.map(|it| it.normal.abs() + it.tangential.abs()).sum();
                assert!(off < allowed * scale + 1e-13 * rounding, "{name}, {way}: {off} J");
                of_walls += now.wall_work;
            }
            assert!(
                name == "turning" || of_walls > 0.0,
                "{name}, {way}: the walls gave {of_walls} J"
            );
        }
    }
}

#[test]
fn momentum_comes_from_gravity_and_from_what_is_no_grain_alone() {
    for stepper in [Stepper::Moreau, Stepper::TgsSoft] {
        let mut run = start(&Scene { stepper, ..shaken() });
        let weight: f64 = run.grains().masses.iter().sum::<f64>() * 9.8;
        for _ in 0..60 {
            let before = momentum(&run);
            run.step().expect("a finite state");
            let numbering = Numbering::of(run.world());
            let list = run.contacts();
            let from_outside: DVec2 = list
                .contacts()
                .iter()
                .zip(list.impulses())
                .filter(|(contact, _)| !matches!(numbering.other(contact.other), Other::Grain(_)))
                .map(|(contact, it)| {
                    it.normal * contact.normal + it.tangential * contact.normal.perp()
                })
                .sum();
            let change = momentum(&run) - before;
            let expected = from_outside - 1e-3 * weight * DVec2::Y;
            assert!(change.distance(expected) < 1e-13, "{stepper}: {change} by {expected}");
        }
    }
}

/// Checks the work of a wall that lifts a grain of mass m by the height h at the constant speed v: m g h to lift the
/// grain (g: gravitational acceleration), ½mv² to accelerate it, and ½mv² that the collision dissipates.
#[test]
fn the_work_of_a_wall_is_what_it_lifts() {
    for (stepper, method) in every_way() {
        let speed = 0.2;
        let grain = Grain::at_rest(DVec2::new(0.05, 0.0), 0.05);
        let mut scene = Scene {
            boundaries: vec![plane(DVec2::ZERO, DVec2::X)],
            motions: vec![goes(&[0], straight(speed * DVec2::X))],
            ..scene(LINE, -9.8 * DVec2::X, parameters(0.0, 1e-3, 0.0, 0.0), vec![grain])
        };
        (scene.stepper, scene.solver.method) = (stepper, method);
        let mut run = start(&scene);
        let (mut of_wall, mut of_gravity) = (0.0, 0.0);
        for _ in 0..1000 {
            let now = run.step().expect("a finite state");
            (of_wall, of_gravity) = (of_wall + now.wall_work, of_gravity + now.gravity_work);
        }
        let mass = run.grains().masses[0];
        let what = format!("{stepper}, {method}");
        assert_close(of_wall, mass * speed * (speed + 9.8), 2e-3, &what);
        assert_close(of_gravity, -mass * 9.8 * speed, 2e-3, &what);
    }
}

/// Checks that without restitution contacts never create energy in a step, even if walls do work on the grains.
#[test]
fn contacts_take_what_walls_give_beyond_the_grains_own() {
    let mut scene = shaken();
    scene.parameters.restitution = 0.0;
    scene.parameters.bond = 0.0;
    scene.solver.max_sweeps = 2000;
    let mut run = after(&scene, 5);
    let mut taken = 0.0;
    for _ in 0..200 {
        let now = *run.step().expect("a finite state");
        let of_contacts = now.normal_work + now.tangential_work - now.wall_work;
        assert!(of_contacts < 1e-7, "{of_contacts} J");
        taken += of_contacts;
    }
    assert!(taken < -1e-4, "{taken} J");
}
