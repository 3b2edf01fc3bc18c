//! Tests of invariance: a run is the same in a moving frame of reference, with a piston (a half-space whose speed
//! is a field of the boundary) in place of an equally moving wall, and in a mirror image.

use crate::common::*;

const VELOCITY: DVec2 = DVec2::new(0.25, 0.15);

/// Returns a scene of grains that rest, fall, overlap and are bonded, on one of five kinds of floor.
fn on_a_floor(shape: usize) -> Scene {
    let mut scene = at_rest_and_falling();
    // Rounding errors decide whether a contact at the threshold bounces, and they depend on the frame.
    scene.parameters.restitution_threshold = 0.0;
    scene.grains[3].velocity = 0.02 * DVec2::X;
    let far = 1.0;
    let at = |x: f64, y: f64| DVec2::new(x, y);
    let corners = vec![at(-far, -far), at(far, -far), at(far, 0.0), at(-far, 0.0)];
    scene.boundaries = match shape {
        0 => vec![level()],
        1 => {
            vec![Boundary::Polyline { points: vec![at(-far, 0.0), at(0.0003, 0.0), at(far, 0.0)] }]
        }
        2 => vec![Boundary::ConvexPolygon { points: corners }],
        3 => Vec::new(),
        _ => vec![piston(DVec2::ZERO, DVec2::Y, 0.0, f64::from(u32::MAX))],
    };
    if shape == 3 {
        // Each grain lies on its own fixed disc.
        let below = |grain: &Grain| fixed(at(grain.position.x, -0.02), 0.02);
        scene.fixed_discs = scene.grains.iter().map(below).collect::<Vec<Disc>>();
    }
    scene
}

/// Runs a scene at rest and in a moving frame of reference. Returns the longest distance between the positions of a
/// grain in the two runs, over all steps, in diameters; the motion of the frame is subtracted.
fn difference_of_views(scene: &Scene) -> f64 {
    let (mut seen, mut velocity) = (scene.clone(), VELOCITY);
    if let Some(Boundary::Piston { speed, .. }) = seen.boundaries.first_mut() {
        (*speed, velocity) = (0.2, 0.2 * DVec2::Y);
    } else {
        seen.motions = vec![Motion {
            boundaries: (0..scene.boundaries.len()).collect(),
            ..discs_go(scene.fixed_discs.len(), straight(VELOCITY))
        }];
    }
    seen.grains.iter_mut().for_each(|grain| grain.velocity += velocity);
    let [mut still, mut moved] = [scene, &seen].map(start);
    let (mut furthest, mut landed) = (0f64, false);
    for _ in 0..150 {
        still.step().expect("a finite state");
        moved.step().expect("a finite state");
        let way = still.time_secs() * velocity;
        let [one, other] = [&still, &moved].map(|run| run.places());
        let ways = one.iter().zip(other).map(|(one, other)| (*one + way).distance(*other));
        furthest = ways.fold(furthest, f64::max);
        landed |= still.place(3).y < 0.51 * scene.mean_diameter;
    }
    assert!(landed, "the disc that falls gets to the floor");
    assert_eq!(moved.observables().lost_grains, 0);
    furthest / scene.mean_diameter
}

#[test]
fn nothing_depends_on_whether_all_that_is_fixed_goes_past_or_the_onlooker() {
    let mut differences = Vec::new();
    for shape in 0..5 {
        let mut scene = on_a_floor(shape);
        for (stepper, method) in every_way() {
            (scene.stepper, scene.solver.method) = (stepper, method);
            for push_out in [false, true] {
                if push_out && (stepper != Stepper::Moreau || (method != Method::Nsgs && shape < 4))
                {
                    continue;
                }
                scene.remedies = Remedies { push_out, ..Remedies::default() };
                let off = difference_of_views(&scene);
                // If the surface speed were missing in a single step, the distance would be 0.02 d. Under `range` a gap
                // of up to 1e-4 d counts as a contact, so the gap of a grain at rest can differ by 1e-4 d.
                let rests = if stepper == Stepper::Range && shape == 3 { 1.1e-4 } else { 1e-5 };
                if off > rests {
                    differences.push((shape, stepper, method, push_out, off));
                }
            }
        }
    }
    assert!(differences.is_empty(), "{differences:?}");
}

/// Returns a scene in which two walls of a box approach with grains between them and then stop. The walls are pistons
/// (half-spaces that move by themselves at a given speed) or half-spaces with a prescribed motion.
fn pressed(normal: DVec2, as_pistons: bool) -> Scene {
    let (speed, travel) = (0.1, 2e-3);
    let mut scene = pressed_pile(30, 0.3, 11, parameters(5.0, 1e-3, 0.3, 0.5));
    let walls = [(normal, -0.02), (DVec2::new(-normal.x, normal.y), -0.02)];
    for (number, (normal, distance)) in walls.into_iter().enumerate() {
        let point = distance * normal;
        if as_pistons {
            scene.boundaries.push(piston(point, normal, speed, travel));
        } else {
            scene.boundaries.push(plane(point, normal));
            let course = MotionCourse::Straight { direction: normal, speed, travel: Some(travel) };
            scene.motions.push(goes(&[number], course));
        }
    }
    scene.solver.max_sweeps = 60;
    scene
}

#[test]
fn a_piston_is_a_half_space_with_a_motion_to_the_last_bit() {
    for (normal, (stepper, method)) in pairs([DVec2::X, DVec2::new(0.8, 0.31)], every_way()) {
        let [mut piston, mut motion] = [true, false].map(|as_pistons| {
            let mut scene = pressed(normal, as_pistons);
            (scene.stepper, scene.solver.method) = (stepper, method);
            start(&scene)
        });
        let mut worked = 0.0;
        for step in 0..40 {
            worked += piston.step().expect("a finite state").wall_work.abs();
            motion.step().expect("a finite state");
            assert_eq!(bits(&piston), bits(&motion), "{stepper}, {method}, step {step}");
            assert_eq!(piston.observables(), motion.observables());
        }
        assert!(worked > 0.0, "{stepper}, {method}: the walls pressed");
    }
}

fn mirrored(vector: DVec2) -> DVec2 {
    DVec2::new(-vector.x, vector.y)
}

/// Returns a scene, or its mirror image, of grains on a shaken floor between a turning wall, a belt and a disc that
/// oscillates.
fn of_all_kinds(mirror: bool) -> Scene {
    let side = |vector: DVec2| if mirror { mirrored(vector) } else { vector };
    let turn = if mirror { -1.0 } else { 1.0 };
    let mut scene = pressed_pile(25, 0.2, 3, parameters(0.0, 5e-4, 0.2, 0.5));
    for grain in &mut scene.grains {
        (grain.position, grain.velocity) = (side(grain.position), side(grain.velocity));
        grain.angular_velocity *= turn;
    }
    for disc in &mut scene.fixed_discs {
        disc.position = side(disc.position);
    }
    let at = |x: f64, y: f64| side(DVec2::new(x, y));
    let pivot = at(-0.02, 0.0);
    scene.boundaries = vec![
        plane(at(0.0, -2e-3), at(0.0, 1.0)),
        Boundary::Segment { from: pivot, to: at(-0.022, 0.04) },
        plane(at(0.02, 0.0), at(-1.0, 0.0)),
    ];
    let sine = MotionCourse::Sine { amplitude: at(1e-3, 5e-4), frequency_hz: 30.0, phase: 0.3 };
    let shaken = Motion { fixed_discs: (0..scene.fixed_discs.len()).collect(), ..goes(&[0], sine) };
    let swing =
        MotionCourse::Swing { pivot, amplitude: -0.3 * turn, frequency_hz: 8.0, phase: 0.0 };
    scene.motions = vec![shaken, goes(&[1], swing), belt(&[2], 0.2 * turn)];
    scene.solver.max_sweeps = 200;
    scene.solver.tolerance = 1e-9;
    scene
}

#[test]
fn a_mirrored_scene_goes_on_mirrored() {
    for &stepper in Stepper::ALL {
        let [mut one, mut other] =
            [false, true].map(|mirror| start(&Scene { stepper, ..of_all_kinds(mirror) }));
        let mut worked = [0.0; 2];
        for _ in 0..60 {
            worked[0] += one.step().expect("a finite state").wall_work;
            worked[1] += other.step().expect("a finite state").wall_work;
        }
        assert_eq!(one.observables().contacts, other.observables().contacts);
        assert!(worked[0] != 0.0, "{stepper}: surfaces work");
        assert_close(worked[0], worked[1], 1e-6, "their work");
        let [one, other] = [&one, &other].map(|run| run.grains());
        for grain in 0..one.len() {
            let off = one.positions[grain].distance(mirrored(other.positions[grain]));
            assert!(off < 1e-10, "{stepper}, grain {grain}: off by {off} m");
            let spins = [one.angular_velocities[grain], -other.angular_velocities[grain]];
            assert!((spins[0] - spins[1]).abs() < 1e-5, "{stepper}, grain {grain}: {spins:?}");
        }
    }
}

/// Checks that a turning wall that hits a resting disc gives it (1 + ρ) times the speed of the contact point, where ρ
/// is the restitution.
#[test]
fn a_paddle_strikes_a_disc_with_the_speed_of_the_point_that_touches() {
    let (radius, arm, rate) = (0.05, 1.0, 2.0);
    for (restitution, shape) in pairs([0.0, 0.5, 1.0], 0..3) {
        let grain = Grain::at_rest(DVec2::new(arm, 0.0), radius);
        let start_angle = DVec2::from_angle(-1.0);
        let boundary = match shape {
            0 => Boundary::Segment { from: DVec2::ZERO, to: 2.0 * start_angle },
            1 => plane(DVec2::ZERO, start_angle.perp()),
            _ => Boundary::ConvexPolygon {
                points: vec![
                    DVec2::ZERO,
                    2.0 * (start_angle - 0.1 * start_angle.perp()),
                    2.0 * start_angle,
                ],
            },
        };
        let physics = Physics { friction: false, rotation: false, ..Physics::FULL };
        let rotation = round(DVec2::ZERO, rate);
        let mut scene = Scene {
            boundaries: vec![boundary],
            motions: vec![goes(&[0], rotation)],
            gravity: Gravity::Uniform { acceleration: DVec2::ZERO },
            ..scene(physics, DVec2::ZERO, parameters(0.0, 1e-4, restitution, 0.0), vec![grain])
        };
        for stepper in [Stepper::Moreau, Stepper::Range] {
            scene.stepper = stepper;
            let mut run = start(&scene);
            // The paddle starts at −1 rad and strikes when it touches the disc, which is asin(radius/arm) before 0 rad.
            // Then the disc flies off.
            let mut steps = 0;
            while run.velocity(0) == DVec2::ZERO {
                run.step().expect("a finite state");
                steps += 1;
                assert!(steps < 6000, "the paddle comes");
            }
            let speed = run.velocity(0).length();
            let touched = (arm * arm - radius * radius).sqrt();
            let what = format!("shape {shape}, {stepper}, ρ = {restitution}");
            assert_close(speed, (1.0 + restitution) * rate * touched, 1e-3, &what);
            let angle = rate * 1e-4 * f64::from(steps);
            assert_close(angle, 1.0 - (radius / arm).asin(), 1e-3, &what);
        }
    }
}
