//! Input of a renderer: discs and straight lines with round ends (links), in pixels, in drawing order, on an opaque
//! background.
//!
//! [`super::Camera::project`] converts positions in the scene to pixels in f64, relative to the middle of the picture,
//! so f32 is sufficient here at any distance from the origin. `shaders/disc.wgsl` and `shaders/link.wgsl` draw the
//! shapes on a GPU, and [`draw`] draws them on the processor by the same formulas for the distance of a pixel from the
//! edge of a shape. [`draw`] rounds to 8 bits after each shape, as a GPU does, so its colour channels differ from every
//! GPU's by at most 3/255.

use glam::{DVec2, Vec2};
use image::RgbaImage;

use super::Colour;

/// A list of shapes of one kind (discs, or links: straight lines with round ends) that are drawn together, from first
/// to last.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Batch {
    Discs(Vec<DiscInstance>),
    Links(Vec<LinkInstance>),
}

/// All shapes of a picture, as input of a renderer. Later batches of shapes cover earlier batches.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Picture {
    /// Colour of the background; its opacity is ignored.
    pub background: Colour,
    pub batches: Vec<Batch>,
}

impl Picture {
    pub(crate) fn new(background: Colour) -> Self {
        Self { background: background.with_alpha(1.0), batches: Vec::new() }
    }

    /// Adds discs on top of the picture. An empty list adds no batch.
    pub(crate) fn push_discs(&mut self, discs: Vec<DiscInstance>) {
        if !discs.is_empty() {
            self.batches.push(Batch::Discs(discs));
        }
    }

    /// Adds straight lines (links) on top of the picture. An empty list adds no batch.
    pub(crate) fn push_links(&mut self, links: Vec<LinkInstance>) {
        if !links.is_empty() {
            self.batches.push(Batch::Links(links));
        }
    }
}

/// Smallest radius with which discs are drawn, pixels. A disc with a smaller radius is drawn with this radius in a
/// fainter colour.
const LEAST_RADIUS_PX: f32 = 0.5;

/// A disc. Lengths are in pixels; positions are relative to the middle of the picture, y up.
#[repr(C)]
#[cfg_attr(feature = "gpu", derive(bytemuck::Pod, bytemuck::Zeroable))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DiscInstance {
    pub centre: [f32; 2],
    /// Radius including the outline, pixels.
    pub radius: f32,
    /// Width of the outline, which lies inside `radius`, pixels; 0 for no outline.
    pub outline_width: f32,
    /// Half of the width of the line from the centre to the outline that shows the disc's angle, pixels; 0 for no line.
    pub mark_half_width: f32,
    /// Cosine and sine of the disc's angle.
    pub direction: [f32; 2],
    pub fill: Colour,
    pub outline: Colour,
}

impl DiscInstance {
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

/// Smallest half width with which lines (links) are drawn, pixels. A line with a smaller half width is drawn with this
/// half width in a fainter colour.
const LEAST_HALF_WIDTH_PX: f32 = 0.5;

/// A link: a straight line with round ends. Lengths are in pixels; positions are relative to the middle of the picture,
/// y up.
#[repr(C)]
#[cfg_attr(feature = "gpu", derive(bytemuck::Pod, bytemuck::Zeroable))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LinkInstance {
    /// One end of the line, at the centre of its round cap.
    pub start: [f32; 2],
    pub end: [f32; 2],
    pub half_width: f32,
    pub colour: Colour,
}

impl LinkInstance {
    pub(super) fn new(ends: [DVec2; 2], half_width: f32, colour: Colour) -> Self {
        let [start, end] = ends.map(|end| end.as_vec2().into());
        Self { start, end, half_width, colour }
    }
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

/// A shape in the plane of the picture, pixels, y up, whose coverage of a pixel follows from the distance of the
/// pixel's centre from the shape's edge.
trait Shade {
    /// Returns two opposite corners of a box around the shape, pixels. Pixels whose centre is outside the box are not
    /// affected by the shape.
    fn bounds(&self) -> [Vec2; 2];
    /// Returns red, green, blue and opacity of the shape at the pixel with the centre `point`. Red, green and blue are
    /// multiplied by the opacity, and all four by the fraction of the pixel that the shape covers.
    fn shade(&self, point: Vec2) -> [f32; 4];
}

/// Returns the fraction of a pixel that a shape covers, 0 to 1. `distance` is the signed distance of the pixel's centre
/// from the shape's edge, pixels, positive outside.
fn coverage(distance: f32) -> f32 {
    (0.5 - distance).clamp(0.0, 1.0)
}

fn scale_colour(colour: [f32; 4], factor: f32) -> [f32; 4] {
    colour.map(|channel| channel * factor)
}

fn mix(from: [f32; 4], to: [f32; 4], part: f32) -> [f32; 4] {
    std::array::from_fn(|channel| from[channel] * (1.0 - part) + to[channel] * part)
}

/// Draws a picture of `width` × `height` pixels on the processor.
pub(super) fn draw(picture: &Picture, width: u32, height: u32) -> RgbaImage {
    let ground = picture.background.with_alpha(1.0).to_rgba8();
    let mut image = RgbaImage::from_pixel(width, height, ground);
    for batch in &picture.batches {
        match batch {
            Batch::Discs(discs) => discs.iter().for_each(|disc| draw_one(&mut image, disc)),
            Batch::Links(links) => links.iter().for_each(|link| draw_one(&mut image, link)),
        }
    }
    image
}

/// Blends a shape over the pixels of its bounding box.
fn draw_one(image: &mut RgbaImage, primitive: &impl Shade) {
    let (width, height) = image.dimensions();
    let middle = Vec2::new(width as f32, height as f32) / 2.0;
    let [low, high] = primitive.bounds();
    // Casts from float to integer saturate, so a box outside the picture becomes an empty range.
    let columns = (low.x + middle.x) as u32..((high.x + middle.x).ceil() as u32).min(width);
    let rows = (middle.y - high.y) as u32..((middle.y - low.y).ceil() as u32).min(height);
    let stride = 4 * width as usize;
    let pixels: &mut [u8] = image;
    for row in rows {
        let y = middle.y - (row as f32 + 0.5);
        let line = &mut pixels[row as usize * stride..][..stride];
        for column in columns.clone() {
            let colour = primitive.shade(Vec2::new(column as f32 + 0.5 - middle.x, y));
            if colour[3] > 0.0 {
                let start = 4 * column as usize;
                blend(&mut line[start..start + 4], colour);
            }
        }
    }
}

fn blend(pixel: &mut [u8], colour: [f32; 4]) {
    let [red, green, blue, alpha] = colour.map(|channel| (channel * 255.0 + 0.5) as u32);
    let through = 255 - alpha;
    for (under, over) in pixel.iter_mut().zip([red, green, blue, alpha]) {
        *under = (over + (u32::from(*under) * through + 127) / 255).min(255) as u8;
    }
}
