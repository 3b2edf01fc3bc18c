//! Tests of floors made of adjoining pieces: seams between the pieces must not disturb a disc that slides or rolls over
//! them.

use crate::common::*;

const RADIUS: f64 = 0.05;

fn at(x: f64) -> DVec2 {
    DVec2::new(x, 0.0)
}

fn segment(from: f64, to: f64) -> Boundary {
    Boundary::Segment { from: at(from), to: at(to) }
}

/// Returns level floors along the x axis from 0 to 4 m, with their names. Most of them consist of pieces of 0.1 m.
fn floors() -> Vec<(&'static str, Vec<Boundary>)> {
    // The end of a piece and the start of the next piece are equal except for rounding.
    let ends = || (0..40).map(|k| (0.1 * f64::from(k), 0.1 * f64::from(k) + 0.1));
    let polygon = |(left, right): (f64, f64), depth: f64| Boundary::ConvexPolygon {
        points: vec![
            at(left) - depth * DVec2::Y,
            at(right) - depth * DVec2::Y,
            at(right),
            at(left),
        ],
    };
    let polygons = |deeper: f64| {
        let depths = [0.1, 0.1 + deeper].into_iter().cycle();
        ends().zip(depths).map(|(ends, depth)| polygon(ends, depth)).collect()
    };
    let props =
        ends().map(|(left, _)| Boundary::Segment { from: at(left) - 0.2 * DVec2::Y, to: at(left) });
    vec![
        ("segments", ends().map(|(left, right)| segment(left, right)).collect()),
        ("segments backward", ends().map(|(left, right)| segment(right, left)).rev().collect()),
        ("segments there and back", {
            let turns = [false, true].into_iter().cycle();
            let piece = |((left, right), turn)| {
                if turn { segment(right, left) } else { segment(left, right) }
            };
            ends().zip(turns).map(piece).collect()
        }),
        ("polygons", polygons(0.0)),
        ("polygons of two depths", polygons(0.1)),
        ("a segment on props", std::iter::once(segment(0.0, 4.0)).chain(props.clone()).collect()),
        ("a half-space on props", props.chain([level()]).collect()),
    ]
}

#[test]
fn a_disc_does_not_feel_where_the_pieces_of_a_floor_meet() {
    let speed = 2.0;
    let ways = [("slides", 0.0, 0.0), ("rolls", 0.5, -speed / RADIUS)];
    for (((name, floor), (way, friction, spin)), &stepper) in
        pairs(pairs(floors(), ways), Stepper::ALL)
    {
        let grain = Grain {
            angular_velocity: spin,
            ..moving(DVec2::new(0.3, RADIUS), RADIUS, speed * DVec2::X)
        };
        let scene = under_g(parameters(0.0, 1e-3, 0.0, friction), vec![grain]);
        let over =
            |boundaries: Vec<Boundary>| start(&Scene { stepper, boundaries, ..scene.clone() });
        let [mut run, mut on_plane] = [over(floor), over(vec![level()])];
        for step in 0..1000 {
            take_steps(&mut run, 1);
            take_steps(&mut on_plane, 1);
            let off = (run.velocity(0).x - speed).abs();
            assert!(off < 1e-6, "{stepper}, {way} over {name}: {off} m/s in step {step}");
            let lower = (run.place(0).y - on_plane.place(0).y).abs();
            assert!(lower < 1e-6, "{stepper}, {way} over {name}: {lower} m in step {step}");
        }
    }
}

/// Checks that a disc hits the seam between two pieces of a floor if one piece rises, and does not feel the seam if
/// both rise together.
#[test]
fn a_seam_is_where_pieces_go_together() {
    let run_over = |second: MotionCourse| {
        let grain = moving(DVec2::new(0.3, RADIUS), RADIUS, 2.0 * DVec2::X);
        let motions = vec![goes(&[0], straight(DVec2::X * 1e-9)), goes(&[1], second)];
        let scene = under_g(parameters(0.0, 1e-3, 0.0, 0.0), vec![grain]);
        let boundaries = vec![segment(0.0, 1.0), segment(1.0, 4.0)];
        after(&Scene { boundaries, motions, ..scene }, 600).velocity(0).x
    };
    // The second piece has risen by 3.5 mm when the disc arrives at the seam.
    let stepped = run_over(straight(DVec2::Y * 1e-2));
    assert!(stepped < 1.9, "{stepped} m/s after a step");
    let grain = moving(DVec2::new(0.3, RADIUS), RADIUS, 2.0 * DVec2::X);
    let motions = vec![goes(&[0, 1], straight(0.1 * DVec2::Y))];
    let scene = under_g(parameters(0.0, 1e-3, 0.0, 0.0), vec![grain]);
    let boundaries = vec![segment(0.0, 1.0), segment(1.0, 4.0)];
    let lifted = after(&Scene { boundaries, motions, ..scene }, 600).velocity(0);
    assert!(lifted.distance(DVec2::new(2.0, 0.1)) < 1e-6, "{lifted}");
}

/// Checks that a disc hits the seam between two pieces of a floor if the user drags one piece 2 mm up, and does not
/// feel the seam without dragging.
#[test]
fn a_hand_opens_and_closes_a_seam() {
    let grain = moving(DVec2::new(0.3, RADIUS), RADIUS, 2.0 * DVec2::X);
    let scene = Scene {
        boundaries: vec![segment(0.0, 1.0), segment(1.0, 4.0)],
        ..under_g(parameters(0.0, 1e-3, 0.0, 0.0), vec![grain])
    };
    let speed_after = |lowered: bool| {
        let mut run = start(&scene);
        if lowered {
            let to = DVec2::new(1.0, 2e-3);
            run.edit(&Edit::Draw { boundary: 1, to }).expect("a wall");
        }
        take_steps(&mut run, 600);
        run.velocity(0).x
    };
    assert_close(speed_after(false), 2.0, 1e-6, "a seam");
    assert!(speed_after(true) < 1.9, "a step: {} m/s", speed_after(true));
}
