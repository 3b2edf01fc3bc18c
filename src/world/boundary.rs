//! Shapes that grains do not move.

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

/// A shape that no grain moves, other than a disc. All lengths in m.
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
    /// A half-space that moves along its normal, whatever is in its way, and then stays.
    Piston {
        /// A point of the surface.
        point: DVec2,
        /// Points out of the solid.
        normal: DVec2,
        /// m/s; positive towards the grains.
        speed: f64,
        /// How far it has still to go.
        travel: f64,
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

impl Boundary {
    /// Its mean velocity in the next `secs`, m/s.
    pub fn velocity(&self, secs: f64) -> DVec2 {
        match *self {
            Self::Piston { normal, speed, travel, .. } => {
                speed.signum() * speed.abs().min(travel / secs) * normal.normalize_or_zero()
            }
            _ => DVec2::ZERO,
        }
    }

    /// Moves it by a part of its way.
    pub fn advance(&mut self, by: DVec2) {
        if let Self::Piston { point, travel, .. } = self {
            *point += by;
            *travel = (*travel - by.length()).max(0.0);
        }
    }
}
