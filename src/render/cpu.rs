//! The renderer that needs no GPU: the shaders' distance fields, evaluated on the processor.
//!
//! For each instance it visits the pixels of its bounding box only and lays the shaded colour over
//! what is there, rounding to 8 bits after every instance as a render target does. That keeps it
//! within 3/255 of every GPU in every channel.

use glam::Vec2;
use image::RgbaImage;

use super::shade::Shade;
use super::{Batch, Picture};

/// Draws a picture of `width` × `height` pixels.
pub(super) fn draw(picture: &Picture, width: u32, height: u32) -> RgbaImage {
    let ground = picture.background.with_alpha(1.0).to_rgba8();
    let mut image = RgbaImage::from_pixel(width, height, ground);
    for batch in &picture.batches {
        match batch {
            Batch::Discs(discs) => discs.iter().for_each(|disc| lay(&mut image, disc)),
            Batch::Links(links) => links.iter().for_each(|link| lay(&mut image, link)),
        }
    }
    image
}

fn lay(image: &mut RgbaImage, primitive: &impl Shade) {
    let (width, height) = image.dimensions();
    let middle = Vec2::new(width as f32, height as f32) / 2.0;
    let [low, high] = primitive.bounds();
    // Casts from float to integer saturate, so a box outside the picture becomes an empty range.
    let columns = (low.x + middle.x) as u32..((high.x + middle.x).ceil() as u32).min(width);
    let rows = (middle.y - high.y) as u32..((middle.y - low.y).ceil() as u32).min(height);
    let stride = 4 * width as usize;
    for row in rows {
        let y = middle.y - (row as f32 + 0.5);
        let line = &mut image.as_mut()[row as usize * stride..][..stride];
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
