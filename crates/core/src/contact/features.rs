//! Fixed shapes, taken apart into features that a disc touches in one point each.

use glam::DVec2;
use parry2d_f64::query::{PointQuery, PointQueryWithLocation};
use parry2d_f64::shape::{HalfSpace, Segment, SegmentPointLocation};

use super::corners::{check_convex, check_finite, count_of};
use crate::error::{Error, Result};
use crate::world::{Boundary, Carry};

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
                features.push(Feature::ConvexPolygon { sides });
            }
        }
        Ok(())
    }

    /// `name` gives what the user calls a point.
    fn collect_chain(
        points: &[DVec2],
        field: &str,
        name: impl Fn(usize) -> String,
        features: &mut Vec<Feature>,
    ) -> Result<()> {
        if points.len() < 2 {
            return Err(Error::value(field, count_of(points, "point"), "at least two points"));
        }
        check_finite(points, &name)?;
        let apart = |ends: &[DVec2]| {
            let distance = ends[0].distance(ends[1]);
            distance > 0.0 && distance.is_finite()
        };
        if let Some(index) = points.windows(2).position(|ends| !apart(ends)) {
            let allowed = format!("apart from {}, at a finite distance", name(index));
            return Err(Error::value(name(index + 1), points[index + 1], allowed));
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

    /// Follows its boundary, which has just been carried: to the last bit what would be made of it anew.
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
            Feature::Segment { shape, before, .. } => {
                follow(shape);
                before.iter_mut().for_each(follow);
            }
            Feature::ConvexPolygon { sides } => sides.iter_mut().for_each(follow),
        }
    }

    /// Its corners, m.
    pub(crate) fn corners(&self) -> impl Iterator<Item = DVec2> + '_ {
        let (segment, sides): (_, &[Segment]) = match self {
            Feature::HalfSpace { .. } => (None, &[]),
            Feature::Segment { shape, .. } => (Some([shape.a, shape.b]), &[]),
            Feature::ConvexPolygon { sides } => (None, sides),
        };
        segment.into_iter().flatten().chain(sides.iter().map(|side| side.a))
    }

    /// Whether it is a half-space.
    pub(crate) fn is_half_space(&self) -> bool {
        matches!(self, Feature::HalfSpace { .. })
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
mod tests;
