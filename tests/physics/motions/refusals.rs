//! Motions that cannot be are refused in one sentence.

use crate::common::*;

fn with(motions: Vec<Motion>) -> Scene {
    let grain = Grain::at_rest(DVec2::Y, 0.1);
    let point = DVec2::new(-3.0, 0.0);
    let piston = Boundary::Piston { point, normal: DVec2::X, speed: 0.1, travel: 1.0 };
    let mut scene = Scene {
        boundaries: vec![level(), piston],
        motions,
        ..scene(Physics::FULL, -G * DVec2::Y, parameters(0.0, 1e-3, 0.0, 0.5), vec![grain])
    };
    scene.fixed_discs = vec![fixed(DVec2::new(2.0, 0.0), 0.1)];
    scene
}

#[track_caller]
fn refused(motion: Motion, expected: &str) {
    let said = with(vec![motion]).simulation().map(|_| ()).expect_err("no such motion");
    assert_eq!(said.to_string(), expected);
}

#[test]
fn motions_of_bodies_that_are_not_there_or_move_already_are_refused() {
    let up = || straight(DVec2::Y);
    refused(
        Motion::default(),
        "motions[0] is of no body, but must be of a boundary or a fixed disc",
    );
    refused(
        goes(&[2], up()),
        "motions[0].boundaries is 2, but must be below 2, the number of boundaries",
    );
    refused(
        Motion { fixed_discs: vec![1], course: Some(up()), ..Motion::default() },
        "motions[0].fixed_discs is 1, but must be below 1, the number of fixed_discs",
    );
    refused(
        goes(&[1], up()),
        "motions[0].boundaries is 1, a piston, but must be a shape that does not move by itself",
    );
    let said = with(vec![goes(&[0], up()), belt(&[0], 1.0)]).simulation().map(|_| ());
    assert_eq!(
        said.expect_err("twice").to_string(),
        "motions[1].boundaries is 0, which motions[0] moves, but must be a body that is named once"
    );
}

#[test]
fn numbers_of_motions_that_cannot_be_are_refused() {
    let travel = Some(-1.0);
    let course = MotionCourse::Straight { direction: DVec2::Y, speed: 1.0, travel };
    refused(goes(&[0], course), "motions[0].course.travel is -1, but must be a finite number ≥ 0");
    let course = MotionCourse::Straight { direction: DVec2::ZERO, speed: 1.0, travel: None };
    refused(
        goes(&[0], course),
        "motions[0].course.direction is [0, 0], but must be finite and not 0",
    );
    let course = MotionCourse::Rotation { pivot: DVec2::ZERO, rate: f64::NAN, travel: None };
    refused(goes(&[0], course), "motions[0].course.rate is NaN, but must be finite");
    let amplitude = DVec2::new(0.0, f64::INFINITY);
    let course = MotionCourse::Sine { amplitude, frequency_hz: 1.0, phase: 0.0 };
    refused(goes(&[0], course), "motions[0].course.amplitude is [0, inf], but must be finite");
    let course =
        MotionCourse::Swing { pivot: DVec2::ZERO, amplitude: 1.0, frequency_hz: -2.0, phase: 0.0 };
    refused(
        goes(&[0], course),
        "motions[0].course.frequency_hz is -2, but must be a finite number ≥ 0",
    );
    refused(belt(&[0], f64::NAN), "motions[0].surface_speed is NaN, but must be finite");
    let table = |times: &[f64], offsets: &[DVec2]| {
        goes(&[0], MotionCourse::Table { times_secs: times.to_vec(), offsets: offsets.to_vec() })
    };
    refused(
        table(&[0.0, 1.0, 1.0], &[DVec2::ZERO; 3]),
        "motions[0].course.times_secs[2] is 1, but must be finite, and above the time before it",
    );
    refused(
        table(&[0.0, 1.0], &[DVec2::ZERO]),
        "motions[0].course.offsets is 1 values at 2 times, but must be one at each of some times",
    );
    refused(
        table(&[0.0], &[DVec2::NAN]),
        "motions[0].course.offsets[0] is not finite, but must be finite",
    );
}

#[test]
fn motions_off_the_x_axis_are_refused_on_a_line() {
    let mut scene = with(Vec::new());
    scene.physics = LINE;
    scene.grains[0].position = DVec2::ZERO;
    scene.gravity = Gravity::Uniform { acceleration: DVec2::ZERO };
    scene.boundaries = vec![plane(-DVec2::X, DVec2::X)];
    scene.motions = vec![goes(&[0], straight(DVec2::X))];
    start(&scene);
    for motion in [goes(&[0], straight(DVec2::ONE)), belt(&[0], 1.0)] {
        scene.motions = vec![motion];
        assert_eq!(
            scene.simulation().map(|_| ()).expect_err("off the axis").to_string(),
            "motions[0] is off the x axis, but must be along the x axis where physics.axes is 1"
        );
    }
}
