//! What a renderer draws: lists of primitives, in drawing order, on an opaque ground.
//!
//! A picture is plain data in pixels. World positions become pixels in [`super::Camera::project`],
//! in f64 and relative to the middle of the picture, so that f32 suffices here however far from the
//! origin the scene lies.

use super::{Colour, DiscInstance, LinkInstance};

/// Primitives of one kind that are drawn together, first to last.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Batch {
    /// Discs.
    Discs(Vec<DiscInstance>),
    /// Links.
    Links(Vec<LinkInstance>),
}

/// All that a renderer needs. Later batches cover earlier ones.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Picture {
    /// Colour of the ground; its opacity is ignored.
    pub background: Colour,
    /// What lies on it.
    pub batches: Vec<Batch>,
}

impl Picture {
    /// A picture with nothing on its ground.
    pub(crate) fn new(background: Colour) -> Self {
        Self { background: background.with_alpha(1.0), batches: Vec::new() }
    }

    /// Lays discs on top; an empty list leaves no batch.
    pub(crate) fn push_discs(&mut self, discs: Vec<DiscInstance>) {
        if !discs.is_empty() {
            self.batches.push(Batch::Discs(discs));
        }
    }

    /// Lays links on top; an empty list leaves no batch.
    pub(crate) fn push_links(&mut self, links: Vec<LinkInstance>) {
        if !links.is_empty() {
            self.batches.push(Batch::Links(links));
        }
    }
}
