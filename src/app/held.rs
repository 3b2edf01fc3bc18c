//! What the mouse points at and holds.

use glam::DVec2;

/// A grain of one of the worlds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GrainRef {
    /// Index of the world.
    pub world: usize,
    /// Index of the grain.
    pub grain: usize,
}

/// A wall in the hand of the mouse.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grip {
    /// Index of the world.
    pub world: usize,
    /// Index of the boundary.
    pub boundary: usize,
    /// From the place of the boundary to where it is held, m.
    pub from_place: DVec2,
    /// Where it was last told to go, m.
    pub sent: Option<DVec2>,
}
