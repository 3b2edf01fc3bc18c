//! Primitive: a filled disc with an outline and, if asked for, a mark that shows its angle.
//!
//! `shaders/disc.wgsl` draws it on the GPU; [`DiscInstance::shade`] is the same distance field for
//! the processor. Both give premultiplied colour times the covered part of the pixel.

use glam::Vec2;

use super::Colour;
#[cfg(feature = "gpu")]
use super::primitive::Instance;
use super::shade::{Shade, coverage, mix, scale_colour};

/// A disc thinner than a pixel is drawn one pixel wide and fainter instead.
const LEAST_RADIUS_PX: f32 = 0.5;

/// One disc. Lengths in pixels; positions relative to the middle of the picture, y up.
#[repr(C)]
#[cfg_attr(feature = "gpu", derive(bytemuck::Pod, bytemuck::Zeroable))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DiscInstance {
    /// Centre.
    pub centre: [f32; 2],
    /// Radius, outline included.
    pub radius: f32,
    /// Width of the outline, which lies inside the radius; 0 for none.
    pub outline_width: f32,
    /// Half the width of the mark from the centre to the outline; 0 for none.
    pub mark_half_width: f32,
    /// Cosine and sine of the angle that the mark shows.
    pub direction: [f32; 2],
    /// Colour inside.
    pub fill: Colour,
    /// Colour of outline and mark.
    pub outline: Colour,
}

impl DiscInstance {
    /// A disc of one colour.
    pub(crate) fn plain(centre: [f32; 2], radius: f32, colour: Colour) -> Self {
        Self {
            centre,
            radius,
            outline_width: 0.0,
            mark_half_width: 0.0,
            direction: [1.0, 0.0],
            fill: colour,
            outline: colour,
        }
    }
}

#[cfg(feature = "gpu")]
impl Instance for DiscInstance {
    const NAME: &'static str = "disc";
    const SHADER: &'static str = include_str!("../../shaders/disc.wgsl");
    const ATTRIBUTES: &'static [wgpu::VertexAttribute] = &wgpu::vertex_attr_array![
        0 => Float32x2, 1 => Float32x3, 2 => Float32x2, 3 => Float32x4, 4 => Float32x4,
    ];
}

impl Shade for DiscInstance {
    fn bounds(&self) -> [Vec2; 2] {
        let centre = Vec2::from(self.centre);
        let reach = Vec2::splat(self.radius.max(LEAST_RADIUS_PX) + 0.5);
        [centre - reach, centre + reach]
    }

    fn shade(&self, point: Vec2) -> [f32; 4] {
        let offset = point - Vec2::from(self.centre);
        let distance = offset.length();

        let radius = self.radius.max(LEAST_RADIUS_PX);
        let faint = (self.radius / LEAST_RADIUS_PX).min(1.0);
        let whole = coverage(distance - radius) * faint * faint;
        let inner_radius = self.radius - self.outline_width;
        let inner = coverage(distance - inner_radius).min(whole);

        let outline = self.outline.premultiplied();
        let mut inside = self.fill.premultiplied();
        if self.mark_half_width > 0.0 {
            let direction = Vec2::from(self.direction);
            let along = offset.dot(direction).clamp(0.0, inner_radius.max(0.0));
            let half_width = self.mark_half_width.max(LEAST_RADIUS_PX);
            let thin = (self.mark_half_width / LEAST_RADIUS_PX).min(1.0);
            let marked = coverage((offset - along * direction).length() - half_width) * thin;
            inside = mix(inside, outline, marked);
        }
        let ring = scale_colour(outline, whole - inner);
        let core = scale_colour(inside, inner);
        std::array::from_fn(|channel| core[channel] + ring[channel])
    }
}
