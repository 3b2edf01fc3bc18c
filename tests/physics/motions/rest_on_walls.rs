//! Tests of discs at rest relative to moving walls: the gap must not change. To ensure this, the velocity of each wall
//! in the contact problem is the exact mean of its velocity over the step.

use super::through_a_file;
use crate::common::*;
use std::f64::consts::{FRAC_PI_2, SQRT_2};

const RADIUS: f64 = 0.05;
const DT: f64 = 1e-3;
/// Overlap of disc and wall at the start, in radii. With this overlap, bonds exist from the start.
const OVERLAP: f64 = 1e-4;

/// Checks that a disc stays in the corner of a square drum that turns at 12 rad/s. The centrifugal acceleration, 2.4
/// times the gravitational acceleration, presses the disc into the corner.
#[test]
fn a_disc_in_the_corner_of_a_drum_that_turns_stays_in_it() {
    let (radius, side, rate) = (0.01, 0.177, 12.0);
    let place = DVec2::splat(side - radius * (1.0 - OVERLAP));
    let corners = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0], [1.0, 1.0]];
    let square = corners.map(|corner| side * DVec2::from(corner)).to_vec();
    let grain = Grain { angular_velocity: rate, ..moving(place, radius, rate * place.perp()) };
    for (&stepper, dt) in pairs(Stepper::ALL, [1e-3, 2e-4]) {
        let scene = Scene {
            stepper,
            solver: SolverSettings::default(),
            boundaries: vec![Boundary::Polyline { points: square.clone() }],
            motions: vec![goes(&[0], round(DVec2::ZERO, rate))],
            ..without_g(parameters(0.0, dt, 0.0, 0.6), vec![grain.clone()])
        };
        let what = format!("{stepper}, {dt} s");
        let run = after(&through_a_file(&scene), (0.5 / dt) as usize);
        // If the mean velocity of the walls had no inward part, the overlap would grow by 0.62 d per second at Δt = 1
        // ms. The tolerance allows for the first step: the disc begins it with the instantaneous velocity, not with the
        // mean over a step.
        let (allowed, far) = if is_rigid(stepper) { (1e-4, 1e-3) } else { (0.05, 0.2) };
        let overlap = run.observables().max_overlap;
        assert!(overlap < allowed, "{what}: overlaps by {overlap} d");
        let expected = DVec2::from_angle(0.5 * rate).rotate(place);
        assert!(run.place(0).distance(expected) < far * radius, "{what}: {}", run.place(0));
        assert_eq!(run.observables().lost_grains, 0, "{what}");
    }
}

fn is_rigid(stepper: Stepper) -> bool {
    [Stepper::Moreau, Stepper::Range].contains(&stepper)
}

/// Bodies that are not grains and together form a valley of 90°.
struct Valley {
    name: &'static str,
    boundaries: Vec<Boundary>,
    fixed_discs: Vec<Disc>,
}

const BOTTOM: DVec2 = DVec2::new(0.3, 0.1);

/// Returns the centre (m) of a disc that lies at the bottom of a valley of 90°.
fn place_in_valley() -> DVec2 {
    BOTTOM + SQRT_2 * RADIUS * (1.0 - OVERLAP) * DVec2::Y
}

/// Returns one valley for each kind of shape that a body other than a grain can have.
fn valleys() -> Vec<Valley> {
    let at = |x: f64, y: f64| BOTTOM + 0.2 * DVec2::new(x, y);
    let [left, bottom, right] = [at(-1.0, 1.0), BOTTOM, at(1.0, 1.0)];
    let polygon = |points: [DVec2; 3]| Boundary::ConvexPolygon { points: points.to_vec() };
    let valley = |name, boundaries| Valley { name, boundaries, fixed_discs: Vec::new() };
    let disc = |side: f64| {
        let reach = RADIUS * (2.0 - OVERLAP) / SQRT_2;
        fixed(place_in_valley() + reach * DVec2::new(side, -1.0), RADIUS)
    };
    vec![
        valley(
            "half-spaces",
            vec![plane(bottom, DVec2::ONE), plane(bottom, DVec2::new(-1.0, 1.0))],
        ),
        valley(
            "segments",
            vec![
                Boundary::Segment { from: left, to: bottom },
                Boundary::Segment { from: right, to: bottom },
            ],
        ),
        valley("polyline", vec![Boundary::Polyline { points: vec![left, bottom, right] }]),
        valley(
            "polygons",
            vec![polygon([bottom, left, at(-1.0, -1.0)]), polygon([right, bottom, at(1.0, -1.0)])],
        ),
        Valley {
            name: "fixed discs",
            boundaries: Vec::new(),
            fixed_discs: vec![disc(-1.0), disc(1.0)],
        },
    ]
}

/// Returns every kind of prescribed motion with its name, and the initial velocity (m/s) and angular velocity (rad/s)
/// of a disc that moves with the body. From 0.5 s on, each motion is uniform, has ended, or repeats itself every half
/// second.
fn courses() -> Vec<(&'static str, MotionCourse, DVec2, f64)> {
    let (pivot, c) = (DVec2::new(0.02, -0.05), place_in_valley());
    let about = |rate: f64| (rate * (c - pivot).perp(), rate);
    let (round_velocity, rate) = about(5.0);
    let (tilting, tilt_rate) = about(0.1);
    let times_secs = vec![0.0, 0.1, 0.2];
    let offsets = [[0.0, 0.0], [5e-3, 2e-3], [4e-3, 6e-3]].map(DVec2::from).to_vec();
    let amplitude = DVec2::new(0.02, 0.03);
    let phase = FRAC_PI_2;
    vec![
        ("rotation", round(pivot, rate), round_velocity, rate),
        (
            "swing",
            MotionCourse::Swing { pivot, amplitude: 0.5, frequency_hz: 2.0, phase },
            DVec2::ZERO,
            0.0,
        ),
        ("sine", MotionCourse::Sine { amplitude, frequency_hz: 4.0, phase }, DVec2::ZERO, 0.0),
        ("straight", straight(DVec2::new(0.4, 0.3)), DVec2::new(0.4, 0.3), 0.0),
        (
            "table",
            MotionCourse::Table { times_secs: times_secs.clone(), offsets },
            DVec2::new(0.05, 0.02),
            0.0,
        ),
        (
            "angle table",
            MotionCourse::AngleTable { pivot, times_secs, angles: vec![0.0, 0.01, 0.005] },
            tilting,
            tilt_rate,
        ),
    ]
}

/// Runs a scene for 1 s. Returns the largest rate at which the gap of a contact has changed between 0.5 s and 1 s, in
/// diameters per second. Fails if the number of contacts at one of these two times is not `contacts`.
fn drift(scene: &Scene, contacts: usize) -> f64 {
    let half = (0.5 / scene.parameters.time_step_secs).round() as usize;
    let mut run = start(scene);
    let mut gaps = |steps: usize| {
        take_steps(&mut run, steps);
        let gaps: Vec<f64> = run.contacts().contacts().iter().map(|contact| contact.gap).collect();
        assert_eq!(gaps.len(), contacts, "contacts at {} s", run.time_secs());
        gaps
    };
    let [then, now] = [gaps(half), gaps(half)];
    let changes = then.iter().zip(&now).map(|(then, now)| (now - then).abs());
    changes.fold(0.0, f64::max) / 0.5 / scene.mean_diameter
}

/// Checks that the change of the gaps in a run of `scene` is proportional to Δt² (second order in the time step Δt), or
/// as small as rounding errors. `contacts` is the number of contacts, and `what` the name of the case in the failure
/// message.
#[track_caller]
fn assert_of_second_order(scene: &Scene, contacts: usize, what: &str) {
    let [coarse, fine] = [1.0, 0.5].map(|part| {
        let mut scene = scene.clone();
        scene.parameters.time_step_secs *= part;
        drift(&scene, contacts)
    });
    // Springs settle slowly and carry the loads of the motion by additional overlap.
    assert!(coarse.max(fine) < 1e-2, "{what}: {coarse:e}, then {fine:e} d per second");
    if is_rigid(scene.stepper) {
        // An overlap of 1e-4 r displaces the contact point by 1e-4 r, so the gap may change by 1e-6 d per second.
        assert!(fine < coarse / 3.5 + 1e-6, "{what}: {coarse:e}, then {fine:e} d per second");
    }
}

/// Checks that a disc that is bonded to a moving valley keeps its gaps, for every stepper, prescribed motion and shape.
#[test]
fn a_disc_that_goes_with_its_walls_keeps_its_gaps_under_every_stepper_motion_and_shape() {
    for ((valley, course), &stepper) in pairs(0..valleys().len(), courses())
        .into_iter()
        .flat_map(|one| Stepper::ALL.iter().map(move |stepper| (one.clone(), stepper)))
    {
        let Valley { name, boundaries, fixed_discs } = valleys().swap_remove(valley);
        let (course_name, course, velocity, spin) = course;
        let motion = Motion {
            boundaries: (0..boundaries.len()).collect(),
            fixed_discs: (0..fixed_discs.len()).collect(),
            course: Some(course),
            ..Motion::default()
        };
        let grain = Grain {
            angular_velocity: spin,
            ..weightless(moving(place_in_valley(), RADIUS, velocity))
        };
        let scene = Scene {
            stepper,
            boundaries,
            fixed_discs,
            motions: vec![motion],
            ..under_g(parameters(20.0, DT, 0.0, 0.6), vec![grain])
        };
        let what = format!("{stepper}, {name}, {course_name}");
        assert_of_second_order(&scene, 2, &what);
        let exact = if stepper == Stepper::Moreau { 1e-9 } else { 1e-5 };
        if is_rigid(stepper) {
            let found = drift(&scene, 2);
            assert!(found < exact, "{what}: {found:e} d per second");
        }
    }
}

/// Checks that a disc that is bonded to a larger disc, which is not a grain, keeps its gap while it moves round with
/// the surface. The larger disc turns, or only its surface moves like a belt.
#[test]
fn a_disc_that_goes_round_with_a_surface_keeps_its_gap() {
    let (large, rate) = (0.2, 4.0);
    let place = DVec2::new(large + RADIUS * (1.0 - OVERLAP), 0.0);
    let belt = Motion { fixed_discs: vec![0], surface_speed: rate * large, ..Motion::default() };
    for (motion, &stepper) in pairs([discs_go(1, round(DVec2::ZERO, rate)), belt], Stepper::ALL) {
        let grain = Grain {
            angular_velocity: rate,
            ..weightless(moving(place, RADIUS, rate * place.perp()))
        };
        let scene = Scene {
            stepper,
            fixed_discs: vec![fixed(DVec2::ZERO, large)],
            motions: vec![motion],
            ..under_g(parameters(20.0, DT, 0.0, 0.6), vec![grain])
        };
        assert_of_second_order(&scene, 1, stepper.name());
    }
}

/// Checks that rollers that turn on the spot under a frictionless disc do not move the disc.
#[test]
fn rollers_that_do_not_rub_leave_what_lies_on_them_in_peace() {
    // Under `range`, shocks do not distinguish a disc that turns from one that moves sideways.
    for &stepper in Stepper::ALL.iter().filter(|&&stepper| stepper != Stepper::Range) {
        let grain = Grain::at_rest(RADIUS * SQRT_2 * (1.0 - OVERLAP) * DVec2::Y, RADIUS);
        let discs = [-1.0, 1.0].map(|side| fixed(side * RADIUS * SQRT_2 * DVec2::X, RADIUS));
        let roller = |disc: usize, rate: f64| Motion {
            fixed_discs: vec![disc],
            course: Some(round(discs[disc].position, rate)),
            ..Motion::default()
        };
        let scene = Scene {
            stepper,
            fixed_discs: discs.to_vec(),
            motions: vec![roller(0, 30.0), roller(1, -70.0)],
            ..scene(SMOOTH, -G * DVec2::Y, parameters(0.0, DT, 0.0, 0.0), vec![grain])
        };
        let found = drift(&scene, 2);
        let allowed = if is_rigid(stepper) { 1e-9 } else { 1e-3 };
        assert!(found < allowed, "{stepper}: {found:e} d per second");
    }
}

/// Checks that the gap of a frictionless disc that slides down a turning plane changes only to the second order in the
/// time step Δt.
#[test]
fn a_disc_that_slides_along_a_wall_that_turns_keeps_its_gap_to_the_second_order() {
    let turning = MotionCourse::Rotation { pivot: DVec2::new(-1.0, 0.0), rate: -0.5, travel: None };
    for stepper in [Stepper::Moreau, Stepper::Range] {
        let grain = moving(RADIUS * (1.0 - OVERLAP) * DVec2::Y, RADIUS, DVec2::new(0.0, -0.5));
        let scene = Scene {
            stepper,
            boundaries: vec![level()],
            motions: vec![goes(&[0], turning.clone())],
            ..scene(SMOOTH, -G * DVec2::Y, parameters(20.0, DT, 0.0, 0.0), vec![grain])
        };
        assert_of_second_order(&scene, 1, stepper.name());
    }
}

/// Checks that a floor that accelerates up and down does not make a disc on it bounce, even with restitution, as long
/// as the disc is pressed against the floor.
#[test]
fn a_disc_on_a_floor_that_is_shaken_does_not_bounce_while_it_is_pressed() {
    let course = MotionCourse::Sine {
        amplitude: DVec2::new(0.0, 0.01),
        frequency_hz: 4.0,
        phase: FRAC_PI_2,
    };
    for stepper in [Stepper::Moreau, Stepper::Range] {
        let grain = Grain::at_rest(RADIUS * (1.0 - OVERLAP) * DVec2::Y, RADIUS);
        let scene = Scene {
            stepper,
            boundaries: vec![level()],
            motions: vec![goes(&[0], course.clone())],
            ..under_g(parameters(0.0, DT, 0.8, 0.5), vec![grain])
        };
        let found = drift(&scene, 1);
        assert!(found < 1e-9, "{stepper}: {found:e} d per second");
        let deepest = after(&scene, 600).observables().max_overlap;
        assert!(deepest < 1e-4, "{stepper}: overlaps by {deepest} d");
    }
}

/// Checks that a drum at 12 rad/s loses no grain. Above 9 rad/s the centrifugal force presses all grains against its
/// wall.
#[test]
fn a_fast_drum_loses_no_grain() {
    let mut scene = built_in("drum").expect("a scene of that name");
    let Some(MotionCourse::Rotation { rate, .. }) = &mut scene.motions[0].course else {
        panic!("a drum turns")
    };
    *rate = 12.0;
    let run = after(&scene, (1.0 / scene.parameters.time_step_secs) as usize);
    assert_eq!(run.observables().lost_grains, 0);
    assert!(run.observables().max_overlap < 0.05, "{} d", run.observables().max_overlap);
}
