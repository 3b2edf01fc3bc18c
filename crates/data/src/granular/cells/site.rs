//! Discs that have cells, and lines that cut these.

use glam::DVec2;

/// What a straight line leaves of a cell: the points p with (p − x)·direction ≤ offset, x the centre of the cell's disc.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cut {
    /// m; negative where the centre is beyond the line.
    pub offset: f64,
    /// Of length 1.
    pub direction: DVec2,
}

/// A disc that has a cell.
#[derive(Clone, Copy)]
pub(super) struct Site {
    pub position: DVec2,
    pub radius: f64,
    /// Radius of the part of the plane that can be its cell, m.
    pub reach: f64,
}
