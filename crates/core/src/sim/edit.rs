//! What a hand can change between two steps, as plain data.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::world::{Boundary, Disc, Edge};

/// Smallest and largest new grain, in mean diameters: beyond, the search for neighbours and the conditioning of
/// steps are those of another scene.
pub const NEW_GRAIN_DIAMETERS: [f64; 2] = [0.2, 5.0];

/// What a hand does between two steps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Edit {
    /// Puts a grain in, at rest, as the last one.
    Add(Disc),
    /// Takes the grain of that number out; those after it are numbered one lower.
    Remove(u32),
    /// Draws a boundary, so that its [`place_of`] goes straight to a point (m) and stays there until the hand
    /// lets go.
    Draw {
        /// Its number.
        boundary: u32,
        /// m.
        to: DVec2,
    },
    /// Lets go of the boundary, which then stays where it is.
    LetGo,
}

/// The point of a boundary that a hand holds, m.
pub fn place_of(boundary: &Boundary) -> DVec2 {
    match boundary.edges().first() {
        Some(Edge::Endless { point, .. }) => *point,
        Some(Edge::Wall([from, _]) | Edge::Side([from, _])) => *from,
        None => DVec2::ZERO,
    }
}
