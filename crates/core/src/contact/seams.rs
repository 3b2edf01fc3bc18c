//! Corners that separate boundaries have in common.
//!
//! A floor may consist of several segments or polygons that lie end to end. While a disc slides towards the end of one
//! piece, its distance from the corner of the next piece is √(x² + r²), hardly more than r if the way x to the corner
//! is short. If the disc overlaps the floor a little, it touches that corner too early, and the corner slows it down.
//!
//! A point of several pieces is the nearest one of their union only if it is the nearest one of each piece; otherwise
//! a piece has a nearer point. So a disc touches a common corner only there. The last of the pieces to which the corner
//! belongs reports the contact, so that it exists once. Within a polyline `Feature::distance` does the same.
//!
//! A corner may also lie on a side of another piece, or on a half-space: then it is never the nearest point.

use parry2d_f64::query::PointQueryWithLocation;
use parry2d_f64::shape::{Segment, SegmentPointLocation};

use glam::DVec2;

use crate::world::Carry;

/// The corners that a feature has in common with features of other boundaries.
#[derive(Clone, Debug, Default)]
pub(crate) struct Seams(pub(super) Vec<Seam>);

/// A corner that lies on another piece.
#[derive(Clone, Debug)]
pub(super) struct Seam {
    /// The number of the corner among those of its feature.
    pub corner: usize,
    /// The piece that the corner lies on.
    pub other: Piece,
    /// The number of that corner among those of the other piece, if it is a corner there.
    pub other_corner: Option<usize>,
    /// True if the other piece comes later.
    pub is_earlier: bool,
}

/// The shape of another feature.
#[derive(Clone, Debug)]
pub(super) enum Piece {
    HalfSpace,
    Segment(Segment),
    ConvexPolygon(Vec<Segment>),
}

impl Seams {
    /// True if no corner lies on another piece.
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// True if a disc with this centre, to which a corner of this feature is nearest, touches the corner and this
    /// feature reports it.
    pub(super) fn reports(&self, corner: usize, centre: DVec2) -> bool {
        self.0.iter().filter(|seam| seam.corner == corner).all(|seam| {
            let nearest = match &seam.other {
                Piece::HalfSpace => None,
                Piece::Segment(segment) => nearest_corner(std::slice::from_ref(segment), centre),
                Piece::ConvexPolygon(sides) => nearest_corner(sides, centre),
            };
            nearest.is_some() && nearest == seam.other_corner && !seam.is_earlier
        })
    }

    /// Moves with the boundaries, which move together.
    pub(super) fn carry(&mut self, carry: &Carry) {
        for Seam { other, .. } in &mut self.0 {
            let segments = match other {
                Piece::HalfSpace => &mut [],
                Piece::Segment(segment) => std::slice::from_mut(segment),
                Piece::ConvexPolygon(sides) => sides.as_mut_slice(),
            };
            for segment in segments {
                (segment.a, segment.b) = (carry.place(segment.a), carry.place(segment.b));
            }
        }
    }
}

/// The number of the corner that is the nearest point of a segment or of a polygon's sides, if a corner is.
pub(super) fn nearest_corner(segments: &[Segment], centre: DVec2) -> Option<usize> {
    let corners = if segments.len() == 1 { 2 } else { segments.len() };
    let nearest = segments.iter().enumerate().map(|(number, segment)| {
        let (nearest, location) = segment.project_local_point_and_get_location(centre, false);
        let corner = match location {
            SegmentPointLocation::OnVertex(end) => Some((number + end as usize) % corners),
            SegmentPointLocation::OnEdge(_) => None,
        };
        (nearest.point.distance_squared(centre), corner)
    });
    nearest.min_by(|one, other| one.0.total_cmp(&other.0))?.1
}
