//! Corners that two separate boundaries share (*seams*), and the rule by which a disc touches a shared corner only
//! once.
//!
//! A floor may consist of several segments or polygons (*pieces*) that lie end to end. While a disc of radius r slides
//! towards the end of one piece, its distance from the corner of the next piece is √(x² + r²). This is hardly more
//! than r if the distance x to the corner is short. If the disc overlaps the floor a little, it touches that corner
//! before it reaches the next piece, and the corner slows the disc down.
//!
//! A point that several pieces share is the point of the whole floor that is nearest to the disc only if it is also the
//! nearest point of each of these pieces. Otherwise one of the pieces has a point that is nearer to the disc. So a disc
//! touches a shared corner only if the corner is, for every piece to which it belongs, the point that is nearest to the
//! disc. Only the last of these pieces in the list of pieces counts the contact, so that the contact exists once.
//! Within a polyline, `Feature::distance` follows the same rule.
//!
//! A corner may also lie on a side of another piece, or on a half-space. Then a contact at this place counts for the
//! other piece, which has a point that is at least as near to the disc, and never for the corner.

use parry2d_f64::query::PointQueryWithLocation;
use parry2d_f64::shape::{Segment, SegmentPointLocation};

use glam::DVec2;

use crate::world::Carry;

/// The corners that a feature (a segment or a polygon) shares with features of other boundaries.
#[derive(Clone, Debug, Default)]
pub(crate) struct Seams(pub(super) Vec<Seam>);

/// A corner of one feature (segment or polygon) that lies on a feature of another boundary, called the other piece.
#[derive(Clone, Debug)]
pub(super) struct Seam {
    /// Index of the corner among the corners of the feature (segment or polygon) that stores it.
    pub corner: usize,
    /// The feature (half-space, segment or polygon) of another boundary on which the corner lies.
    pub other: Piece,
    /// Index of the shared corner among the corners of the feature of another boundary on which it lies. `None` if the
    /// corner lies on a side of that feature, not at one of its corners.
    pub other_corner: Option<usize>,
    /// True if the wall piece (segment or polygon) with this corner comes before the other wall piece that shares the
    /// corner, in the list of all wall pieces. A grain that touches the corner would touch both pieces, so the contact
    /// is counted for the later piece only.
    pub is_earlier: bool,
}

/// Shape of a feature (half-space, segment or polygon) of one boundary, on which a corner of another boundary lies.
#[derive(Clone, Debug)]
pub(super) enum Piece {
    HalfSpace,
    Segment(Segment),
    ConvexPolygon(Vec<Segment>),
}

impl Seams {
    /// True if none of the corners of a segment or polygon lies on another boundary, so that it shares no corner.
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns true if the contact between a disc and corner number `corner` of this feature (segment or polygon) is
    /// counted for this feature, and not for another feature that shares the corner. The disc has its centre at
    /// `centre` (m), and the corner is the point of this feature that is nearest to the disc.
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

    /// Moves the stored shapes of the other features that share corners with this feature (segment or polygon) by the
    /// displacement `carry`. Features that share a corner always move together.
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

/// Returns the index of the corner that is the nearest point of a segment, or of the sides of a polygon, to `centre`.
/// `None` if the nearest point lies inside a side.
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
