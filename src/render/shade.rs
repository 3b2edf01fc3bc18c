//! What the primitives' distance fields have in common on the processor.

use glam::Vec2;

/// A primitive as a distance field in the plane of the picture, pixels, y up.
pub(super) trait Shade {
    /// Corners of a box outside which the primitive has no effect on pixel middles.
    fn bounds(&self) -> [Vec2; 2];
    /// Premultiplied colour, times the covered part, of the pixel with this middle.
    fn shade(&self, point: Vec2) -> [f32; 4];
}

/// Covered part of a pixel whose middle is `distance` px outside an edge.
pub(super) fn coverage(distance: f32) -> f32 {
    (0.5 - distance).clamp(0.0, 1.0)
}

pub(super) fn scale_colour(colour: [f32; 4], factor: f32) -> [f32; 4] {
    colour.map(|channel| channel * factor)
}

pub(super) fn mix(from: [f32; 4], to: [f32; 4], part: f32) -> [f32; 4] {
    std::array::from_fn(|channel| from[channel] * (1.0 - part) + to[channel] * part)
}
