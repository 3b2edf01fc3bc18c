//! Tests that Slump refuses impossible motions, driving forces, periodic cells and turns of gravity with an error
//! message of one sentence.

use super::driven::{drive_of, pressed};
use super::sheared::{cell, gas};
use crate::common::*;

/// Returns a scene with a grain over a floor, a piston at the side, a disc that is not a grain, and the given motions.
fn with(motions: Vec<Motion>) -> Scene {
    let piston = piston(DVec2::new(-3.0, 0.0), DVec2::X, 0.1, 1.0);
    Scene {
        boundaries: vec![level(), piston],
        motions,
        fixed_discs: vec![fixed(DVec2::new(2.0, 0.0), 0.1)],
        ..of_one(Grain::at_rest(DVec2::Y, 0.1), 0.5)
    }
}

fn of_one(grain: Grain, friction: f64) -> Scene {
    under_g(parameters(0.0, 1e-3, 0.0, friction), vec![grain])
}

#[track_caller]
fn motions_refused(cases: &[(&str, Motion)]) {
    for (expected, motion) in cases {
        assert_said(&refused(&with(vec![motion.clone()])), expected);
    }
}

#[test]
fn motions_of_bodies_that_are_not_there_or_move_already_are_refused() {
    let up = || straight(DVec2::Y);
    let of_disc = Motion { fixed_discs: vec![1], course: Some(up()), ..Motion::default() };
    motions_refused(&[
        ("motions[0] is of no body, but must be of a boundary or a fixed disc", Motion::default()),
        (
            "motions[0].boundaries is 2, but must be below 2, the number of boundaries",
            goes(&[2], up()),
        ),
        ("motions[0].fixed_discs is 1, but must be below 1, the number of fixed_discs", of_disc),
        (
            "motions[0].boundaries is 1, a piston, but must be a shape that does not move by itself",
            goes(&[1], up()),
        ),
    ]);
    assert_eq!(
        refused(&with(vec![goes(&[0], up()), belt(&[0], 1.0)])),
        "motions[1].boundaries is 0, which motions[0] moves, but must be a body that is named once"
    );
}

#[test]
fn numbers_of_motions_that_cannot_be_are_refused() {
    use MotionCourse::{Sine, Straight, Swing, Table};
    let (direction, travel, pivot) = (DVec2::Y, Some(-1.0), DVec2::ZERO);
    let amplitude = DVec2::new(0.0, f64::INFINITY);
    let table = |times: &[f64], offsets: &[DVec2]| Table {
        times_secs: times.to_vec(),
        offsets: offsets.to_vec(),
    };
    let course = |course: MotionCourse| goes(&[0], course);
    motions_refused(&[
        (
            "motions[0].course.travel is -1, but must be a finite number ≥ 0",
            course(Straight { direction, speed: 1.0, travel }),
        ),
        (
            "motions[0].course.direction is [0, 0], but must be finite and not 0",
            course(Straight { direction: DVec2::ZERO, speed: 1.0, travel: None }),
        ),
        ("motions[0].course.rate is NaN, but must be finite", course(round(DVec2::ZERO, f64::NAN))),
        (
            "motions[0].course.amplitude is [0, inf], but must be finite",
            course(Sine { amplitude, frequency_hz: 1.0, phase: 0.0 }),
        ),
        (
            "motions[0].course.frequency_hz is -2, but must be a finite number ≥ 0",
            course(Swing { pivot, amplitude: 1.0, frequency_hz: -2.0, phase: 0.0 }),
        ),
        ("motions[0].surface_speed is NaN, but must be finite", belt(&[0], f64::NAN)),
        (
            "motions[0].course.times_secs[2] is 1, but must be finite, and above the time before it",
            course(table(&[0.0, 1.0, 1.0], &[DVec2::ZERO; 3])),
        ),
        (
            "motions[0].course.offsets is 1 values at 2 times, but must be one at each of some times",
            course(table(&[0.0, 1.0], &[DVec2::ZERO])),
        ),
        (
            "motions[0].course.offsets[0] is not finite, but must be finite",
            course(table(&[0.0], &[DVec2::NAN])),
        ),
    ]);
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
            refused(&scene),
            "motions[0] is off the x axis, but must be along the x axis where physics.axes is 1"
        );
    }
}

#[test]
fn ways_to_step_that_know_of_no_driven_wall_are_refused() {
    let mut taken = 0;
    for (stepper, method) in every_way() {
        let mut scene = pressed(1.0);
        (scene.stepper, scene.solver.method) = (stepper, method);
        if stepper.info().takes_drives && (!stepper.uses_method() || method.info().takes_drives) {
            start(&scene);
            taken += 1;
            continue;
        }
        let said = refused(&scene);
        assert!(said.ends_with(" where a motion has a drive"), "{said}");
        let mut run = start(&pressed(1.0));
        assert_eq!(run.change(scene.settings()).expect_err("nor while it runs").to_string(), said);
    }
    assert!(taken >= 5);
    for model in [FrictionModel::Associated, FrictionModel::Desaxce] {
        let allowed = "must be coulomb or tresca where a motion has a drive";
        let expected = format!("friction-model is {model}, but {allowed}");
        refuses(&pressed(1.0), &[(&expected, &|scene| scene.solver.friction_model = model)]);
    }
    let refused = Stepper::ALL.iter().filter(|stepper| !stepper.info().takes_drives);
    assert!(refused.eq(&[Stepper::Avbd]));
}

#[test]
fn drives_that_cannot_be_are_refused_in_one_sentence() {
    for mass in [0.0, -1.0, f64::NAN] {
        let expected =
            format!("motions[0].drive.mass is {mass}, but must be a finite number of kg > 0");
        refuses(&pressed(1.0), &[(&expected, &|scene| drive_of(scene).mass = mass)]);
    }
    refuses(
        &pressed(1.0),
        &[
            ("motions[0].drive.pressure is NaN, but must be a finite number of N/m", &|scene| {
                drive_of(scene).pressure = Some(f64::NAN)
            }),
            (
                "motions[0].drive.force is given with a pressure, but must be given, or else a pressure, and not both",
                &|scene| drive_of(scene).force = Some(1.0),
            ),
            ("motions[0].drive.force is left out, but…", &|scene| {
                drive_of(scene).pressure = None
            }),
            ("motions[0].drive.damping is -1, but…", &|scene| drive_of(scene).damping = -1.0),
            ("motions[0].drive.direction is [0, 0], but…", &|scene| {
                drive_of(scene).direction = DVec2::ZERO
            }),
            ("motions[0].drive.width is 0, but…", &|scene| {
                (drive_of(scene).pressure, drive_of(scene).width) = (Some(1.0), Some(0.0))
            }),
            ("motions[0].course is along [1, 1], but must be across…", &|scene| {
                scene.motions[0].course = Some(straight(DVec2::new(1.0, 1.0)))
            }),
            ("motions[0].course is of another kind, but must be…", &|scene| {
                scene.motions[0].course = Some(round(DVec2::ZERO, 1.0))
            }),
            ("motions[0].drive.width is left out, but must be given…", &|scene| {
                scene.periodic = None
            }),
        ],
    );
}

#[test]
fn gravity_that_cannot_turn_so_is_refused() {
    let turn = |course: TurnCourse| Some(GravityTurn { course, elapsed_secs: 0.0 });
    let table = |times: [f64; 2], angles: [f64; 2]| {
        turn(TurnCourse::Table { times_secs: times.into(), angles: angles.into() })
    };
    let mut good = of_one(Grain::at_rest(DVec2::ZERO, 0.1), 0.5);
    good.gravity_turn = turn(TurnCourse::Rate { rate: 0.4 });
    refuses(
        &good,
        &[
            (
                "gravity_turn is given, but must be left out where gravity is not uniform",
                &|scene| {
                    scene.gravity = Gravity::Attraction { centre: DVec2::ZERO, magnitude: 1.0 }
                },
            ),
            ("gravity_turn is given, but must be left out where physics.axes is 1", &|scene| {
                scene.physics = LINE
            }),
            ("gravity_turn.course.rate is inf, but must be finite", &|scene| {
                scene.gravity_turn = turn(TurnCourse::Rate { rate: f64::INFINITY })
            }),
            (
                "gravity_turn.course.times_secs[1] is 0.5, but must be finite, and above the time before it",
                &|scene| scene.gravity_turn = table([1.0, 0.5], [0.0, 1.0]),
            ),
            ("gravity_turn.course.angles[1] is not finite, but must be finite", &|scene| {
                scene.gravity_turn = table([0.0, 0.5], [0.0, f64::NAN])
            }),
        ],
    );
}

#[test]
fn what_has_no_direction_is_not_tilted() {
    let of = |mut scene: Scene, degrees: f64| {
        scene.parameters.tilt = degrees;
        scene.validate().expect_err("it cannot be tilted so").to_string()
    };
    let cradle = of(built_in("cradle").expect("a scene"), 5.0);
    assert_eq!(cradle, "tilt is 5, but must be left out or 0 where gravity is not uniform");
    let far = of(at_rest_and_falling(), 200.0);
    assert_eq!(far, "tilt is 200, but must be between -180 and 180 degrees");
}

fn along_y(y: [f64; 2]) -> Periodic {
    Periodic { y: Some(y), ..Periodic::default() }
}

#[test]
fn cells_that_cannot_be_are_refused_in_one_sentence() {
    let (x, y) = (Periodic::along_x, along_y);
    let segment = |to: DVec2| vec![Boundary::Segment { from: DVec2::ZERO, to }];
    let nothing = Vec::new;
    let mut line = of_one(Grain::at_rest(DVec2::new(0.2, 0.0), 0.1), 0.5);
    line.physics = LINE;
    line.gravity = Gravity::Uniform { acceleration: DVec2::ZERO };
    line.periodic = Some(y([0.0, 1.0]));
    assert_eq!(refused(&line), "periodic.y is given, but must be left out where physics.axes is 1");
    let cases = [
        (
            x([0.0, 0.5]),
            vec![level()],
            "periodic.x is [0, 0.5], but must be at least 0.6000000000000001 m wide: 3 times the largest diameter, \
             and twice as far as discs feel each other",
        ),
        (x([1.0, -1.0]), vec![level()], "periodic.x is [1, -1], but must be at…"),
        (
            x([0.0, f64::NAN]),
            vec![level()],
            "periodic.x is [0, NaN], but must be two finite numbers of m",
        ),
        (
            x([0.0, 1.0]),
            vec![plane(DVec2::ZERO, DVec2::X)],
            "boundaries[0] is a half-space that does not go on across it, but must be level, or between the borders \
             of periodic.x",
        ),
        (x([0.0, 1.0]), segment(1.1 * DVec2::X), "boundaries[0] is a segment that…"),
        (
            y([0.0, 0.5]),
            nothing(),
            "periodic.y is [0, 0.5], but must be at least 0.6000000000000001 m high: 3 times the largest diameter, \
             and twice as far as discs feel each other",
        ),
        (Periodic::along_both([0.0, 0.5], [0.0, 1.0]), nothing(), "periodic.x is [0, 0.5], but…"),
        (
            y([0.0, 1.0]),
            vec![level()],
            "boundaries[0] is a half-space that does not go on across it, but must be upright, or between the borders \
             of periodic.y",
        ),
        (
            Periodic::default(),
            nothing(),
            "periodic is without borders, but must be given with x, y or both",
        ),
        (y([0.0, 1.0]), segment(1.1 * DVec2::Y), "boundaries[0] is a segment that does not go on…"),
    ];
    let mut scene = of_one(Grain::at_rest(DVec2::new(0.2, 0.5), 0.1), 0.5);
    for (cell, boundaries, expected) in cases {
        (scene.periodic, scene.boundaries) = (Some(cell), boundaries);
        assert_said(&refused(&scene), expected);
    }
    (scene.periodic, scene.boundaries) = (Some(x([0.0, 1.0])), segment(0.9 * DVec2::X));
    refuses(
        &scene,
        &[
            ("motions[0].course is along x…", &|scene| {
                scene.motions = vec![goes(&[0], straight(DVec2::X))]
            }),
            ("motions[0].course is round a pivot, but must be…", &|scene| {
                scene.motions = vec![goes(&[0], round(DVec2::ZERO, 1.0))]
            }),
        ],
    );
}

/// Checks that Slump refuses scenes with two discs that are at the same position across a side border, the lower
/// border, or a corner of a periodic cell.
#[test]
fn two_discs_in_one_place_across_a_border_are_refused() {
    let both = Periodic::along_both([0.0, 1.0], [0.0, 1.0]);
    for (cell, places) in [
        (Periodic::along_x([0.0, 1.0]), [DVec2::new(0.99, 0.0), DVec2::new(0.01, 0.0)]),
        (both, [DVec2::new(0.5, 0.99), DVec2::new(0.5, 0.01)]),
        (both, [DVec2::splat(0.99), DVec2::ZERO]),
    ] {
        let mut twins = of_one(Grain::at_rest(places[0], 0.1), 0.0);
        twins.grains.push(Grain::at_rest(places[1], 0.1));
        start(&twins);
        twins.periodic = Some(cell);
        let said = refused(&twins);
        assert!(said.contains("from that of grains[0]"), "{said}");
    }
}

#[test]
fn what_borders_that_slide_would_tear_is_refused_in_one_sentence() {
    let good = gas(1.0, 0.5, 0.3);
    refuses(
        &good,
        &[
            (
                "periodic.shear_rate is 2, but must be 0 unless both periodic.x and periodic.y are given",
                &|scene| scene.periodic = Some(Periodic { y: None, ..cell(2.0) }),
            ),
            ("periodic.shear_rate is NaN, but must be a finite number", &|scene| {
                scene.periodic = Some(cell(f64::NAN))
            }),
            (
                "periodic.shift is 0.2, but must be from -0.11 to 0.11 m, a width of the cell",
                &|scene| scene.periodic = Some(Periodic { shift: 0.2, ..cell(0.0) }),
            ),
            (
                "periodic.shear_rate is 1, but must be 0 unless physics has friction and rotation; mu = 0 is no matter",
                &|scene| scene.physics = SMOOTH,
            ),
            (
                "periodic.shear_rate is 1, but must be 0 where there are boundaries or fixed discs, which cannot go with it",
                &|scene| scene.fixed_discs = vec![fixed(DVec2::ZERO, 0.001)],
            ),
            ("periodic.shear_rate…", &|scene| scene.boundaries = vec![level()]),
            ("…", &|scene| {
                scene.motions =
                    vec![Motion { course: Some(straight(DVec2::X)), ..Motion::default() }]
            }),
        ],
    );
    for info in METHODS.iter().filter(|info| !info.takes_shear) {
        let expected = format!("solver is {}, but must be nsgs or …", info.name);
        refuses(&good, &[(&expected, &|scene| scene.solver.method = info.method)]);
        let mut run = start(&good);
        let mut settings = *run.settings();
        settings.solver.method = info.method;
        run.change(settings).expect_err("not while it runs either");
    }
}
