//! How words lie relative to a point and to each other.

/// Where a block lies relative to the point at which it is drawn, along one direction. Also how
/// the lines of a block lie relative to each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Align {
    /// The point is at the left or top edge.
    #[default]
    Start,
    /// The point is in the middle.
    Centre,
    /// The point is at the right or bottom edge.
    End,
}

impl Align {
    /// Distance from the start of something `length` long to its point.
    pub(super) fn share(self, length: u32) -> u32 {
        match self {
            Self::Start => 0,
            Self::Centre => length / 2,
            Self::End => length,
        }
    }
}
