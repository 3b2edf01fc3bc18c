//! Fixed shapes, taken apart into features that a disc touches in one point each.

use glam::DVec2;
use parry2d_f64::query::{PointQuery, PointQueryWithLocation};
use parry2d_f64::shape::{HalfSpace, Segment, SegmentPointLocation};

use crate::error::{Error, Result};
use crate::world::Boundary;

/// A part of a boundary that a disc touches in at most one point.
#[derive(Clone, Debug)]
pub(crate) enum Feature {
    /// A half-space.
    HalfSpace {
        /// A point of the surface, m.
        point: DVec2,
        /// The half-space through the origin.
        shape: HalfSpace,
    },
    /// A segment, solid from both sides. Where it follows or precedes another one of its polyline,
    /// the shared corner is told once: by the later segment, and only where both have it as their
    /// nearest point (elsewhere the other's inner part is nearer).
    Segment {
        /// The segment.
        shape: Segment,
        /// The one before it.
        before: Option<Segment>,
        /// Whether another one follows.
        has_next: bool,
    },
    /// A solid convex polygon, anticlockwise.
    ConvexPolygon {
        /// Its sides.
        sides: Vec<Segment>,
    },
}

impl Feature {
    /// Takes a boundary apart and appends its features to `features`.
    ///
    /// # Errors
    /// Names the boundary (`field`) and the part of it that makes no shape.
    pub(crate) fn collect(
        boundary: &Boundary,
        field: &str,
        features: &mut Vec<Feature>,
    ) -> Result<()> {
        let finite = |points: &[DVec2]| points.iter().all(|point| point.is_finite());
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
                Self::collect_chain(&[*from, *to], field, features)?;
            }
            Boundary::Polyline { points } => Self::collect_chain(points, field, features)?,
            Boundary::ConvexPolygon { points } => {
                let count = points.len();
                let turn = |k: usize| {
                    let [a, b, c] = [points[k], points[(k + 1) % count], points[(k + 2) % count]];
                    (b - a).perp_dot(c - b)
                };
                let convex = count >= 3 && finite(points) && (0..count).all(|k| turn(k) > 0.0);
                if !convex {
                    let allowed = "at least three finite corners, anticlockwise and convex";
                    return Err(Error::value(field, format!("{count} corners"), allowed));
                }
                let sides =
                    (0..count).map(|k| Segment::new(points[k], points[(k + 1) % count])).collect();
                features.push(Feature::ConvexPolygon { sides });
            }
        }
        Ok(())
    }

    fn collect_chain(points: &[DVec2], field: &str, features: &mut Vec<Feature>) -> Result<()> {
        let proper = points.windows(2).all(|ends| ends[0].distance(ends[1]) > 0.0)
            && points.iter().all(|point| point.is_finite());
        if points.len() < 2 || !proper {
            let found = format!("{} points", points.len());
            return Err(Error::value(
                field,
                found,
                "at least two finite points, no two in a row equal",
            ));
        }
        let mut before = None;
        for (index, ends) in points.windows(2).enumerate() {
            let shape = Segment::new(ends[0], ends[1]);
            let has_next = index + 2 < points.len();
            features.push(Feature::Segment { shape, before, has_next });
            before = Some(shape);
        }
        Ok(())
    }

    /// Moves it, m.
    pub(crate) fn shift(&mut self, by: DVec2) {
        let shift =
            |segment: &mut Segment| (segment.a, segment.b) = (segment.a + by, segment.b + by);
        match self {
            Feature::HalfSpace { point, .. } => *point += by,
            Feature::Segment { shape, before, .. } => {
                shift(shape);
                before.iter_mut().for_each(shift);
            }
            Feature::ConvexPolygon { sides } => sides.iter_mut().for_each(shift),
        }
    }

    /// Whether it goes on for ever, and what is on it may roll as far as it likes.
    pub(crate) fn is_endless(&self) -> bool {
        match self {
            Feature::HalfSpace { .. } => true,
            Feature::Segment { .. } | Feature::ConvexPolygon { .. } => false,
        }
    }

    /// Whether it is solid: what is deep inside is lost.
    pub(crate) fn is_solid(&self) -> bool {
        match self {
            Feature::HalfSpace { .. } | Feature::ConvexPolygon { .. } => true,
            Feature::Segment { .. } => false,
        }
    }

    /// Distance of `centre` from the surface (m), corners that another feature tells of included:
    /// they may be this one's a moment later. Negative in solids.
    pub(crate) fn distance_to_any_point(&self, centre: DVec2) -> f64 {
        match self {
            Feature::Segment { shape, .. } => shape.distance_to_local_point(centre, false),
            Feature::HalfSpace { .. } | Feature::ConvexPolygon { .. } => {
                self.distance(centre).map_or(f64::INFINITY, |(_, distance)| distance)
            }
        }
    }

    /// Unit normal towards `centre` and distance of `centre` from the surface (m, negative inside),
    /// or nothing where another feature tells of this point.
    pub(crate) fn distance(&self, centre: DVec2) -> Option<(DVec2, f64)> {
        match self {
            Feature::HalfSpace { point, shape } => {
                let offset = centre - *point;
                let projection = shape.project_local_point(offset, false);
                let distance = offset.distance(projection.point);
                Some((shape.normal, if projection.is_inside { -distance } else { distance }))
            }
            Feature::Segment { shape, before, has_next } => {
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
                Some(outward(centre, nearest.point, left_of(shape)))
            }
            Feature::ConvexPolygon { sides } => {
                // Inside, the way out is through the side whose line is nearest. Outside, the
                // surface's nearest point is that of the nearest side.
                let depth = |side: &Segment| (centre - side.a).dot(-left_of(side));
                let deepest = sides.iter().map(|side| (depth(side), -left_of(side)));
                let (depth, normal) =
                    deepest.fold((f64::NEG_INFINITY, DVec2::ZERO), |most, next| {
                        if next.0 > most.0 { next } else { most }
                    });
                if depth <= 0.0 {
                    return Some((normal, depth));
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

/// The unit normal on the left of a segment; inward for the side of an anticlockwise polygon.
fn left_of(segment: &Segment) -> DVec2 {
    (segment.b - segment.a).perp().normalize_or_zero()
}

/// Unit normal and distance from `nearest` to `centre`; `fallback` where the two coincide.
fn outward(centre: DVec2, nearest: DVec2, fallback: DVec2) -> (DVec2, f64) {
    let offset = centre - nearest;
    let distance = offset.length();
    (if distance > 0.0 { offset / distance } else { fallback }, distance)
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn a_feature_that_is_shifted_takes_all_of_its_surface_along() {
        let corners = [DVec2::ZERO, DVec2::X, DVec2::new(0.5, 1.0)].to_vec();
        let by = DVec2::new(4.0, -8.0);
        for boundary in [
            Boundary::HalfSpace { point: DVec2::ONE, normal: DVec2::new(1.0, 2.0) },
            Boundary::Polyline { points: corners.clone() },
            Boundary::ConvexPolygon { points: corners },
        ] {
            for mut feature in features(boundary) {
                for centre in [DVec2::new(0.5, 0.25), DVec2::new(1.5, -0.5), DVec2::new(0.5, 2.0)] {
                    let before = feature.clone();
                    feature.shift(by);
                    let [then, now] = [before.distance(centre), feature.distance(centre + by)];
                    assert_eq!(then.is_some(), now.is_some());
                    for ((old, far), (new, distance)) in then.into_iter().zip(now) {
                        assert!(old.distance(new) < 1e-14 && (far - distance).abs() < 1e-14);
                    }
                    feature = before;
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
            assert!(error.is_err_and(|error| error.to_string().starts_with("boundaries[3] is")));
        }
    }
}
