use super::*;
use crate::world::{Motion, MotionCourse};

fn features(boundary: Boundary) -> Vec<Feature> {
    let mut features = Vec::new();
    Feature::collect(&boundary, "boundary", &mut features).expect("a proper boundary");
    features
}

fn hits(features: &[Feature], x: f64, y: f64) -> Vec<(DVec2, f64)> {
    features.iter().filter_map(|feature| feature.distance(DVec2::new(x, y))).collect()
}

#[test]
fn a_convex_corner_of_a_polyline_touches_once_and_a_valley_twice() {
    let ridge = features(Boundary::Polyline {
        points: vec![DVec2::new(-1.0, 0.0), DVec2::ZERO, DVec2::new(1.0, -1.0)],
    });
    let above_the_corner = hits(&ridge, 0.1, 1.0);
    assert_eq!(above_the_corner.len(), 1);
    assert!((above_the_corner[0].1 - 1.01f64.sqrt()).abs() < 1e-15);
    let valley = features(Boundary::Polyline {
        points: vec![DVec2::new(-1.0, 1.0), DVec2::ZERO, DVec2::new(1.0, 1.0)],
    });
    assert_eq!(hits(&valley, 0.0, 0.5).len(), 2);
}

#[test]
fn a_polygon_pushes_out_through_its_nearest_side() {
    let square = features(Boundary::ConvexPolygon {
        points: vec![DVec2::ZERO, DVec2::new(1.0, 0.0), DVec2::new(1.0, 1.0), DVec2::new(0.0, 1.0)],
    });
    let (normal, distance) = hits(&square, 0.5, 0.9)[0];
    assert!(normal.distance(DVec2::Y) < 1e-15 && (distance + 0.1).abs() < 1e-15);
    let (normal, distance) = hits(&square, 1.3, 1.4)[0];
    assert!(normal.distance(DVec2::new(0.6, 0.8)) < 1e-14 && (distance - 0.5).abs() < 1e-15);
}

#[test]
fn a_feature_that_is_carried_takes_all_of_its_surface_along() {
    let corners = [DVec2::ZERO, DVec2::X, DVec2::new(0.5, 1.0)].to_vec();
    let straight = Motion {
        course: Some(MotionCourse::Straight {
            direction: DVec2::new(1.0, -2.0),
            speed: 9.0,
            travel: None,
        }),
        ..Motion::default()
    };
    let turning = MotionCourse::Rotation { pivot: DVec2::new(-1.0, 3.0), rate: -2.5, travel: None };
    let turning = Motion { course: Some(turning), ..Motion::default() };
    for (boundary, motion) in [
        Boundary::HalfSpace { point: DVec2::ONE, normal: DVec2::new(1.0, 2.0) },
        Boundary::Segment { from: DVec2::ONE, to: DVec2::new(0.0, 0.5) },
        Boundary::Polyline { points: corners.clone() },
        Boundary::ConvexPolygon { points: corners },
    ]
    .into_iter()
    .flat_map(|boundary| [&straight, &turning].map(|motion| (boundary.clone(), motion)))
    {
        let carry = motion.velocity_in(0.7).carry(0.7);
        let mut there = boundary.clone();
        there.carry(&carry);
        let made_anew = features(there.clone());
        for (feature, anew) in features(boundary).into_iter().zip(made_anew) {
            let mut moved = feature.clone();
            moved.carry(&carry, &there);
            assert_eq!(format!("{moved:?}"), format!("{anew:?}"), "to the last bit");
            for centre in [DVec2::new(0.5, 0.25), DVec2::new(1.5, -0.5), DVec2::new(0.5, 2.0)] {
                let [then, now] = [feature.distance(centre), moved.distance(carry.place(centre))];
                assert_eq!(then.is_some(), now.is_some());
                for ((old, far), (new, distance)) in then.into_iter().zip(now) {
                    let off = carry.turned(old).distance(new);
                    assert!(off < 1e-14 && (far - distance).abs() < 1e-14);
                }
            }
        }
    }
}

#[test]
fn shapes_that_are_none_are_refused_with_their_field() {
    let clockwise = vec![DVec2::ZERO, DVec2::new(0.0, 1.0), DVec2::new(1.0, 0.0)];
    for boundary in [
        Boundary::HalfSpace { point: DVec2::ZERO, normal: DVec2::ZERO },
        Boundary::Segment { from: DVec2::ONE, to: DVec2::ONE },
        Boundary::Polyline { points: vec![DVec2::ONE] },
        Boundary::ConvexPolygon { points: clockwise },
        Boundary::HalfSpace { point: DVec2::NAN, normal: DVec2::Y },
    ] {
        let error = Feature::collect(&boundary, "boundaries[3]", &mut Vec::new());
        assert!(error.is_err_and(|error| error.to_string().starts_with("boundaries[3]")));
    }
}

#[test]
fn a_star_is_not_convex_and_a_refusal_names_the_number_that_is_wrong() {
    let refusal = |boundary: Boundary| {
        let refused = Feature::collect(&boundary, "boundaries[0]", &mut Vec::new());
        refused.expect_err("no shape").to_string()
    };
    let corner =
        |k: usize, step: f64| DVec2::from_angle(0.4 * std::f64::consts::PI * step * k as f64);
    let of =
        |step: f64| Boundary::ConvexPolygon { points: (0..5).map(|k| corner(k, step)).collect() };
    assert_eq!(features(of(1.0)).len(), 1, "a pentagon");
    let said = refusal(of(2.0));
    assert_eq!(
        said,
        "boundaries[0] is 5 corners that go around 2 times, but must be convex: corners that go around once"
    );
    let said = refusal(Boundary::Segment { from: DVec2::ONE, to: DVec2::ONE });
    assert_eq!(
        said,
        "boundaries[0].to is [1, 1], but must be apart from boundaries[0].from, at a finite distance"
    );
    let points = vec![DVec2::ZERO, DVec2::X, DVec2::new(f64::NAN, 0.0)];
    let said = refusal(Boundary::Polyline { points: points.clone() });
    assert_eq!(said, "boundaries[0].points[2] is [NaN, 0], but must be finite");
    assert_eq!(refusal(Boundary::ConvexPolygon { points }), said);
    let dent = vec![DVec2::ZERO, DVec2::X, DVec2::new(0.4, 0.3), DVec2::Y];
    assert!(
        refusal(Boundary::ConvexPolygon { points: dent }).starts_with("boundaries[0].points[2] is")
    );
    assert!(refusal(Boundary::Polyline { points: vec![DVec2::X] }).contains("is 1 point, but"));
}
