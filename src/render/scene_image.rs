//! The finished picture of a scene: primitives, then words, then the legend's strip.

use image::RgbaImage;
use image::imageops;

use super::align::Align;
use super::font::TextStyle;
use super::layers::scene_picture;
use super::legend::Legend;
use super::scale_bar::ScaleBar;
use super::text::TextBlock;
use super::{Camera, Renderer, Style};
use crate::error::Result;
use crate::sim::Snapshot;

/// Draws a snapshot with scale bar and legend, `width` × `height` pixels in all. The camera looks
/// at the part left of the legend; [`Style::camera`] makes one.
///
/// # Errors
/// Names `size` if it is empty or too large; otherwise says what the device reported.
pub fn draw_scene(
    renderer: &mut Renderer,
    snapshot: &Snapshot,
    style: &Style,
    camera: &Camera,
    width: u32,
    height: u32,
) -> Result<RgbaImage> {
    renderer.check_size(width, height)?;
    let palette = style.theme.palette();
    let strip_width = style.legend_width(width, height);
    let scene_width = width - strip_width;
    let picture = scene_picture(snapshot, style, camera, scene_width, height);
    let mut image = renderer.draw(&picture, scene_width, height)?;
    if style.scale_bar {
        let bar = ScaleBar::new(style, camera, scene_width, height);
        let label = TextBlock::new(&bar.label, &TextStyle::new(bar.text_px, palette.ink));
        let x = scene_width as f32 / 2.0 + bar.end[0] + 0.5 * bar.text_px;
        let y = height as f32 / 2.0 - bar.end[1];
        label.draw(&mut image, x as i64, y as i64, Align::Start, Align::Centre);
    }
    if strip_width == 0 {
        return Ok(image);
    }
    let legend = Legend::of(snapshot, style, camera, style.text_px(width, height));
    let mut whole = RgbaImage::new(width, height);
    imageops::replace(&mut whole, &image, 0, 0);
    imageops::replace(&mut whole, &legend.draw(strip_width, height), i64::from(scene_width), 0);
    Ok(whole)
}
