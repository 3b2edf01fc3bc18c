//! Shapes that never move.

use glam::DVec2;
use serde::{Deserialize, Serialize};

/// A disc that never moves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Disc {
    /// Centre, m.
    pub position: DVec2,
    /// Radius, m.
    pub radius: f64,
}

/// A shape that never moves, other than a disc. All lengths in m.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "shape", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Boundary {
    /// All points p with (p − point)·normal < 0. The normal need not have length 1.
    HalfSpace {
        /// A point of the surface.
        point: DVec2,
        /// Points out of the solid.
        normal: DVec2,
    },
    /// A thin wall from one point to another, solid from both sides.
    Segment {
        /// One end.
        from: DVec2,
        /// The other end.
        to: DVec2,
    },
    /// Segments end to end, solid from both sides.
    Polyline {
        /// At least two points.
        points: Vec<DVec2>,
    },
    /// A solid convex polygon.
    ConvexPolygon {
        /// At least three corners, anticlockwise.
        points: Vec<DVec2>,
    },
}
