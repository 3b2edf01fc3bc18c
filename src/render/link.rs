//! Primitive: a straight stroke with round ends, for force chains, walls and bars.
//!
//! `shaders/link.wgsl` draws it on the GPU; [`LinkInstance::shade`] is the same distance field for
//! the processor. Both give premultiplied colour times the covered part of the pixel.

use glam::Vec2;

use super::Colour;
#[cfg(feature = "gpu")]
use super::primitive::Instance;
use super::shade::{Shade, coverage, scale_colour};

/// A link thinner than a pixel is drawn one pixel wide and fainter instead.
const LEAST_HALF_WIDTH_PX: f32 = 0.5;

/// One link. Lengths in pixels; positions relative to the middle of the picture, y up.
#[repr(C)]
#[cfg_attr(feature = "gpu", derive(bytemuck::Pod, bytemuck::Zeroable))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LinkInstance {
    /// One end, in the middle of its round cap.
    pub start: [f32; 2],
    /// The other end.
    pub end: [f32; 2],
    /// Half the width.
    pub half_width: f32,
    /// Colour.
    pub colour: Colour,
}

#[cfg(feature = "gpu")]
impl Instance for LinkInstance {
    const NAME: &'static str = "link";
    const SHADER: &'static str = include_str!("../../shaders/link.wgsl");
    const ATTRIBUTES: &'static [wgpu::VertexAttribute] = &wgpu::vertex_attr_array![
        0 => Float32x2, 1 => Float32x2, 2 => Float32, 3 => Float32x4,
    ];
}

impl Shade for LinkInstance {
    fn bounds(&self) -> [Vec2; 2] {
        let (start, end) = (Vec2::from(self.start), Vec2::from(self.end));
        let reach = Vec2::splat(self.half_width.max(LEAST_HALF_WIDTH_PX) + 0.5);
        [start.min(end) - reach, start.max(end) + reach]
    }

    fn shade(&self, point: Vec2) -> [f32; 4] {
        let start = Vec2::from(self.start);
        let offset = point - start;
        let span = Vec2::from(self.end) - start;
        let squared = span.length_squared();
        let part = if squared > 0.0 { (offset.dot(span) / squared).clamp(0.0, 1.0) } else { 0.0 };
        let distance = (offset - span * part).length();

        let half_width = self.half_width.max(LEAST_HALF_WIDTH_PX);
        let faint = (self.half_width / LEAST_HALF_WIDTH_PX).min(1.0);
        scale_colour(self.colour.premultiplied(), coverage(distance - half_width) * faint)
    }
}
