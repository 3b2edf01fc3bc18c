//! Boundaries (walls and other shapes that are not discs), divided into features: half-spaces, segments and convex
//! polygons. A disc touches each feature in at most one point.

use glam::DVec2;
use parry2d_f64::query::{PointQuery, PointQueryWithLocation};
use parry2d_f64::shape::{HalfSpace, Segment, SegmentPointLocation};

use super::seams::{Seams, nearest_corner};
use crate::error::{self, Error, Result};
use crate::world::{Boundary, Carry};

/// A half-space, segment or convex polygon that is a part of a boundary. A disc touches it in at most one point.
#[derive(Clone, Debug)]
pub(crate) enum Feature {
    /// A half-space.
    HalfSpace {
        /// A point of the straight surface of the half-space, m.
        point: DVec2,
        /// A copy of this half-space that is moved so that its surface passes through the origin.
        shape: HalfSpace,
    },
    /// A segment that discs can touch from both sides. Neighbouring segments of a polyline share a corner. A contact of
    /// a disc with this corner counts for the later segment only. It exists only if the corner is, for both segments,
    /// the point that is nearest to the disc. Otherwise an inner point of one of the two segments is nearer to the
    /// disc.
    Segment {
        /// The segment.
        shape: Segment,
        /// The previous segment of the polyline, if there is one.
        before: Option<Segment>,
        /// True if another segment of the polyline follows.
        has_next: bool,
        /// The end points of this segment that lie on other boundaries.
        seams: Seams,
    },
    /// A solid convex polygon with its corners in anticlockwise order.
    ConvexPolygon {
        /// The sides of the polygon.
        sides: Vec<Segment>,
        /// The corners of this polygon that lie on other boundaries.
        seams: Seams,
    },
}

impl Feature {
    /// Divides a boundary into features (half-spaces, segments, polygons) and appends them to `features`.
    ///
    /// # Errors
    /// If the boundary is not a valid shape. The error names the boundary (`field`) or its invalid point.
    pub(crate) fn collect(
        boundary: &Boundary,
        field: &str,
        features: &mut Vec<Feature>,
    ) -> Result<()> {
        match boundary {
            Boundary::HalfSpace { point, normal } => {
                let length = normal.length();
                if !(point.is_finite() && length.is_finite() && length > 0.0) {
                    let found = format!("point {point}, normal {normal}");
                    return Err(Error::value(field, found, "finite with a normal that is not 0"));
                }
                let shape = HalfSpace::new(*normal / length);
                features.push(Feature::HalfSpace { point: *point, shape });
            }
            Boundary::Piston { point, normal, speed, travel } => {
                if !(speed.is_finite() && *travel >= 0.0 && travel.is_finite()) {
                    let found = format!("speed {speed}, travel {travel}");
                    let allowed = "finite with a travel of at least 0 m";
                    return Err(Error::value(field, found, allowed));
                }
                let at_rest = Boundary::HalfSpace { point: *point, normal: *normal };
                Self::collect(&at_rest, field, features)?;
            }
            Boundary::Segment { from, to } => {
                let name = |index| format!("{field}.{}", ["from", "to"][index]);
                Self::collect_chain(&[*from, *to], field, name, features)?;
            }
            Boundary::Polyline { points } => {
                let name = |index| format!("{field}.points[{index}]");
                Self::collect_chain(points, field, name, features)?;
            }
            Boundary::ConvexPolygon { points } => {
                check_convex(points, field)?;
                let count = points.len();
                let sides =
                    (0..count).map(|k| Segment::new(points[k], points[(k + 1) % count])).collect();
                features.push(Feature::ConvexPolygon { sides, seams: Seams::default() });
            }
        }
        Ok(())
    }

    /// Checks a chain of points (finite, and each apart from the next) and appends the segments between neighbouring
    /// points to `features`. `name` receives the index of a point in the chain and returns the name of the point for
    /// error messages.
    fn collect_chain(
        points: &[DVec2],
        field: &str,
        name: impl Fn(usize) -> String,
        features: &mut Vec<Feature>,
    ) -> Result<()> {
        error::check(points.len() >= 2, field, count_of(points, "point"), "at least two points")?;
        check_finite(points, &name)?;
        let apart = |ends: &[DVec2]| {
            let distance = ends[0].distance(ends[1]);
            distance > 0.0 && distance.is_finite()
        };
        if let Some(index) = points.windows(2).position(|ends| !apart(ends)) {
            let allowed = format!("apart from {}, at a finite distance", name(index));
            return Err(Error::value(name(index + 1), points[index + 1], allowed));
        }
        let segments = || points.windows(2).map(|ends| Segment::new(ends[0], ends[1]));
        let closes = points.first() == points.last();
        let mut before = segments().next_back().filter(|_| closes);
        for (index, shape) in segments().enumerate() {
            let has_next = closes || index + 2 < points.len();
            features.push(Feature::Segment { shape, before, has_next, seams: Seams::default() });
            before = Some(shape);
        }
        Ok(())
    }

    /// Moves this feature (half-space, segment or polygon) by the displacement `carry` of its boundary. `boundary` is
    /// the boundary after the move. The result is bitwise equal to a feature built from the moved boundary.
    pub(crate) fn carry(&mut self, carry: &Carry, boundary: &Boundary) {
        let follow = |segment: &mut Segment| {
            (segment.a, segment.b) = (carry.place(segment.a), carry.place(segment.b));
        };
        match self {
            Feature::HalfSpace { point, shape } => {
                *point = carry.place(*point);
                if let Boundary::HalfSpace { normal, .. } = boundary {
                    *shape = HalfSpace::new(*normal / normal.length());
                }
            }
            Feature::Segment { shape, before, seams, .. } => {
                follow(shape);
                before.iter_mut().for_each(follow);
                seams.carry(carry);
            }
            Feature::ConvexPolygon { sides, seams } => {
                sides.iter_mut().for_each(follow);
                seams.carry(carry);
            }
        }
    }

    /// The corners that this feature (segment or polygon) shares with features of other boundaries. `None` for a
    /// half-space, which has no corners.
    pub(super) fn seams_mut(&mut self) -> Option<&mut Seams> {
        match self {
            Feature::HalfSpace { .. } => None,
            Feature::Segment { seams, .. } | Feature::ConvexPolygon { seams, .. } => Some(seams),
        }
    }

    /// The corners of this part of a boundary: the ends of a segment or the corners of a polygon, m. Empty for a
    /// half-space.
    pub(crate) fn corners(&self) -> impl Iterator<Item = DVec2> + '_ {
        let (segment, sides): (_, &[Segment]) = match self {
            Feature::HalfSpace { .. } => (None, &[]),
            Feature::Segment { shape, .. } => (Some([shape.a, shape.b]), &[]),
            Feature::ConvexPolygon { sides, .. } => (None, sides),
        };
        segment.into_iter().flatten().chain(sides.iter().map(|side| side.a))
    }

    /// True if this part of a boundary is a half-space, not a segment or polygon.
    pub(crate) fn is_half_space(&self) -> bool {
        matches!(self, Feature::HalfSpace { .. })
    }

    /// Returns the distance (m) of `centre` from the surface of this part of a boundary (half-space, segment or
    /// polygon), negative inside solids. A corner that two parts share counts for both, while [`Self::distance`] counts
    /// it for one of them only. The search for pairs that may touch needs both parts, because a small motion of the
    /// disc may change the part for which the corner counts.
    pub(crate) fn distance_to_any_point(&self, centre: DVec2) -> f64 {
        match self {
            Feature::Segment { shape, .. } => shape.distance_to_local_point(centre, false),
            Feature::HalfSpace { point, shape } => (centre - *point).dot(shape.normal),
            Feature::ConvexPolygon { sides, .. } => {
                let (_, depth) = way_out(sides, centre);
                let distances =
                    sides.iter().map(|side| side.distance_to_local_point(centre, false));
                if depth <= 0.0 { depth } else { distances.fold(f64::INFINITY, f64::min) }
            }
        }
    }

    /// Returns the unit normal towards `centre`, and the distance of `centre` from the surface of this part of a
    /// boundary (half-space, segment or polygon), m, negative inside solids. `None` if the point of this part that is
    /// nearest to `centre` is a corner which it shares with a second part, and a contact at this corner counts for the
    /// second part.
    pub(crate) fn distance(&self, centre: DVec2) -> Option<(DVec2, f64)> {
        match self {
            Feature::HalfSpace { point, shape } => {
                let offset = centre - *point;
                let projection = shape.project_local_point(offset, false);
                let distance = offset.distance(projection.point);
                Some((shape.normal, if projection.is_inside { -distance } else { distance }))
            }
            Feature::Segment { shape, before, has_next, seams } => {
                let (nearest, location) = shape.project_local_point_and_get_location(centre, false);
                match location {
                    SegmentPointLocation::OnVertex(1) if *has_next => return None,
                    SegmentPointLocation::OnVertex(0) => {
                        if let Some(before) = before {
                            let (_, location) =
                                before.project_local_point_and_get_location(centre, false);
                            if !matches!(location, SegmentPointLocation::OnVertex(1)) {
                                return None;
                            }
                        }
                    }
                    _ => {}
                }
                if let SegmentPointLocation::OnVertex(end) = location
                    && !seams.reports(end as usize, centre)
                {
                    return None;
                }
                Some(outward(centre, nearest.point, left_of(shape)))
            }
            Feature::ConvexPolygon { sides, seams } => {
                // Outside the polygon, the nearest point of the surface is the nearest point of the nearest side.
                let (normal, depth) = way_out(sides, centre);
                if depth <= 0.0 {
                    return Some((normal, depth));
                }
                if !seams.is_empty()
                    && let Some(corner) = nearest_corner(sides, centre)
                    && !seams.reports(corner, centre)
                {
                    return None;
                }
                let nearest =
                    sides.iter().map(|side| side.project_local_point(centre, false).point).min_by(
                        |a, b| a.distance_squared(centre).total_cmp(&b.distance_squared(centre)),
                    )?;
                Some(outward(centre, nearest, normal))
            }
        }
    }
}

/// Finds the side of a convex polygon from whose line the point `place` has the largest signed distance (negative
/// inside the polygon, positive outside). For a point inside, this is the nearest side. Returns the outward normal of
/// the side, and the signed distance, m.
fn way_out(sides: &[Segment], place: DVec2) -> (DVec2, f64) {
    let lines = sides.iter().map(|side| (-left_of(side), (place - side.a).dot(-left_of(side))));
    lines.fold(
        (DVec2::ZERO, f64::NEG_INFINITY),
        |most, next| if next.1 > most.1 { next } else { most },
    )
}

/// Returns the unit normal on the left of a segment. For a side of an anticlockwise polygon this normal points
/// inward.
fn left_of(segment: &Segment) -> DVec2 {
    (segment.b - segment.a).perp().normalize_or_zero()
}

/// Returns the unit normal and the distance (m) from `nearest` to `centre`. `fallback` is the normal if the two
/// points coincide.
fn outward(centre: DVec2, nearest: DVec2, fallback: DVec2) -> (DVec2, f64) {
    let offset = centre - nearest;
    let distance = offset.length();
    (if distance > 0.0 { offset / distance } else { fallback }, distance)
}

fn check_finite(points: &[DVec2], name: impl Fn(usize) -> String) -> Result<()> {
    match points.iter().position(|point| !point.is_finite()) {
        Some(index) => Err(Error::value(name(index), points[index], "finite")),
        None => Ok(()),
    }
}

/// Checks that the points are the corners of a convex polygon, once around and anticlockwise. It is not enough that
/// the outline turns left at each corner, because the outline of a pentagram also does so but goes around twice. So
/// the function also counts how often the direction of the sides passes from the lower into the upper half of the
/// plane: once for a single round.
fn check_convex(points: &[DVec2], field: &str) -> Result<()> {
    let count = points.len();
    error::check(count >= 3, field, count_of(points, "corner"), "at least three corners")?;
    check_finite(points, |index| format!("{field}.points[{index}]"))?;
    let side = |k: usize| points[(k + 1) % count] - points[k % count];
    if let Some(k) = (0..count).find(|&k| side(k + count - 1).perp_dot(side(k)) <= 0.0) {
        let allowed = "a corner at which the polygon turns left: convex and anticlockwise";
        return Err(Error::value(format!("{field}.points[{k}]"), points[k], allowed));
    }
    let upwards = |side: DVec2| side.y > 0.0 || (side.y == 0.0 && side.x > 0.0);
    let rounds = (0..count).filter(|&k| !upwards(side(k)) && upwards(side(k + 1))).count();
    if rounds != 1 {
        let found = format!("{count} corners that go around {rounds} times");
        return Err(Error::value(field, found, "convex: corners that go around once"));
    }
    Ok(())
}

fn count_of(points: &[DVec2], what: &str) -> String {
    format!("{} {what}{}", points.len(), if points.len() == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
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
        // The points are in clockwise order, so the outside is on the left. The first and the last point are at the
        // top.
        let [top, right, left] = [(0.0, 1.0), (1.0, 0.0), (-1.0, 0.0)].map(DVec2::from);
        let closed = features(Boundary::Polyline { points: vec![top, right, left, top] });
        for (corner, (x, y)) in [(top, (0.1, 1.5)), (right, (1.5, -0.1)), (left, (-1.5, -0.1))] {
            let distance = corner.distance(DVec2::new(x, y));
            let near = hits(&closed, x, y).into_iter().filter(|hit| hit.1 < 1.01 * distance);
            assert_eq!(near.count(), 1, "{x} {y}");
        }
    }

    #[test]
    fn a_polygon_pushes_out_through_its_nearest_side() {
        let square = features(Boundary::ConvexPolygon {
            points: vec![
                DVec2::ZERO,
                DVec2::new(1.0, 0.0),
                DVec2::new(1.0, 1.0),
                DVec2::new(0.0, 1.0),
            ],
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
        let turning =
            MotionCourse::Rotation { pivot: DVec2::new(-1.0, 3.0), rate: -2.5, travel: None };
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
                    let [then, now] =
                        [feature.distance(centre), moved.distance(carry.place(centre))];
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
        let of = |step: f64| Boundary::ConvexPolygon {
            points: (0..5).map(|k| corner(k, step)).collect(),
        };
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
            refusal(Boundary::ConvexPolygon { points: dent })
                .starts_with("boundaries[0].points[2] is")
        );
        assert!(refusal(Boundary::Polyline { points: vec![DVec2::X] }).contains("is 1 point, but"));
    }
}
