//! Bodies that are not grains: fixed discs, walls and other boundaries, with their geometry, outline and own motion
//! (pistons). `contact::features` computes how a disc touches boundaries.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::motion::{Carry, RigidVelocity, within};
use crate::number::Parts;

/// Position and radius of a disc. As a body of a world it is a fixed disc: it is at rest, or has a prescribed or
/// force-driven motion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Disc {
    /// Centre, m.
    pub position: DVec2,
    /// Radius, m.
    pub radius: f64,
}

/// A wall or another shape, other than a disc, that is at rest or has a prescribed or force-driven motion. All lengths
/// are in m.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "shape", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Boundary {
    /// A solid half-space, which contains all points p with (p − point)·normal < 0.
    HalfSpace {
        /// A point of the surface of the half-space.
        point: DVec2,
        /// Normal that points out of the solid. It need not have length 1.
        normal: DVec2,
    },
    /// A half-space that moves along its normal with a given speed and then stops. Forces of grains do not slow it
    /// down. It is a short form for a half-space with a straight [`Motion`](super::Motion).
    Piston {
        /// A point of the surface of the piston.
        point: DVec2,
        /// Normal that points out of the solid. It need not have length 1.
        normal: DVec2,
        /// Speed of the piston, m/s; positive towards the grains.
        speed: f64,
        /// Remaining distance before the piston stops, m.
        travel: f64,
    },
    /// A thin wall from one point to another. Grains can touch it from both sides.
    Segment {
        /// One end of the wall.
        from: DVec2,
        /// The other end of the wall.
        to: DVec2,
    },
    /// A chain of thin walls, end to end. Grains can touch it from both sides.
    Polyline {
        /// The corners of the chain in order, at least two points.
        points: Vec<DVec2>,
    },
    /// A solid convex polygon.
    ConvexPolygon {
        /// The corners of the polygon, at least three, in anticlockwise order.
        points: Vec<DVec2>,
    },
}

/// A line or line segment of the outline of a boundary, for drawing. All lengths are in m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Edge {
    /// An infinite line, the surface of a half-space.
    Endless {
        /// A point of the line.
        point: DVec2,
        /// Normal that points out of the solid. It need not have length 1.
        normal: DVec2,
    },
    /// A thin wall between two points, with grains on both sides.
    Wall([DVec2; 2]),
    /// A side of a solid, from the first to the second point. The solid is on the left.
    Side([DVec2; 2]),
}

// The matches below have no `_` arm, so that a new shape must be considered in each.
impl Boundary {
    /// Returns the lines and line segments of the outline of this boundary, for drawing.
    pub fn edges(&self) -> Vec<Edge> {
        match self {
            Self::HalfSpace { point, normal } | Self::Piston { point, normal, .. } => {
                vec![Edge::Endless { point: *point, normal: *normal }]
            }
            Self::Segment { from, to } => vec![Edge::Wall([*from, *to])],
            Self::Polyline { points } => {
                points.windows(2).map(|ends| Edge::Wall([ends[0], ends[1]])).collect()
            }
            Self::ConvexPolygon { points } => {
                let nexts = points.iter().cycle().skip(1);
                points.iter().zip(nexts).map(|(from, to)| Edge::Side([*from, *to])).collect()
            }
        }
    }

    /// Returns the name of this kind of shape in scene files.
    pub const fn word(&self) -> &'static str {
        match self {
            Self::HalfSpace { .. } => "half-space",
            Self::Piston { .. } => "piston",
            Self::Segment { .. } => "segment",
            Self::Polyline { .. } => "polyline",
            Self::ConvexPolygon { .. } => "convex-polygon",
        }
    }

    /// True if the shape is a half-space whose surface is perpendicular to the x axis. Scenes on a line allow only
    /// such boundaries.
    pub fn is_across_line(&self) -> bool {
        match self {
            Self::HalfSpace { normal, .. } | Self::Piston { normal, .. } => normal.y == 0.0,
            Self::Segment { .. } | Self::Polyline { .. } | Self::ConvexPolygon { .. } => false,
        }
    }

    /// True if the shape moves without a [`Motion`](super::Motion) in the scene, as a piston does.
    pub(crate) fn moves_by_itself(&self) -> bool {
        matches!(self, Self::Piston { .. })
    }

    /// Returns the mean velocity, in the next `secs` seconds, of a shape that moves without a
    /// [`Motion`](super::Motion) in the scene, as a piston does. `None` for other shapes.
    pub(crate) fn velocity_in(&self, secs: f64) -> Option<RigidVelocity> {
        match *self {
            Self::Piston { normal, speed, travel, .. } => {
                let speed = within(speed, Some(travel), secs);
                Some(RigidVelocity::straight(speed * normal.normalize_or_zero()))
            }
            Self::HalfSpace { .. }
            | Self::Segment { .. }
            | Self::Polyline { .. }
            | Self::ConvexPolygon { .. } => None,
        }
    }

    pub(crate) fn carry(&mut self, carry: &Carry) {
        let move_all = |points: &mut [DVec2]| {
            points.iter_mut().for_each(|point| *point = carry.place(*point));
        };
        match self {
            Self::HalfSpace { point, normal } => {
                *point = carry.place(*point);
                *normal = carry.turned(*normal);
            }
            Self::Piston { point, travel, .. } => {
                *point = carry.place(*point);
                *travel = (*travel - carry.by.length()).positive_part();
            }
            Self::Segment { from, to } => {
                (*from, *to) = (carry.place(*from), carry.place(*to));
            }
            Self::Polyline { points } | Self::ConvexPolygon { points } => move_all(points),
        }
    }

    /// True if a displacement in `direction` moves the surface only along its normal, so that the surface does not rub
    /// against grains.
    pub(crate) fn is_pushed_along(&self, direction: DVec2) -> bool {
        match self {
            Self::HalfSpace { normal, .. } | Self::Piston { normal, .. } => {
                normal.perp_dot(direction) == 0.0
            }
            Self::Segment { .. } | Self::Polyline { .. } | Self::ConvexPolygon { .. } => false,
        }
    }

    /// True if the shape is a half-space, whose surface is an infinite line.
    pub(crate) fn is_half_space(&self) -> bool {
        matches!(self, Self::HalfSpace { .. } | Self::Piston { .. })
    }
}
