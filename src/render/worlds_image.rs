//! The finished picture of several scenes side by side, with one legend.

use image::{RgbaImage, imageops};

use super::align::Align;
use super::font::TextStyle;
use super::legend::{Legend, fill};
use super::text::TextBlock;
use super::{Camera, Renderer, Style, draw_scene};
use crate::error::{Error, Result};
use crate::sim::Snapshot;

/// How dark the lines between scenes are.
const FRAME: f32 = 0.25;

/// One of the scenes.
#[derive(Clone, Copy, Debug)]
pub struct Panel<'a> {
    /// What is shown.
    pub snapshot: &'a Snapshot,
    /// What it is, in its upper left corner.
    pub title: &'a str,
    /// What came of it, in its lower right corner.
    pub note: &'a str,
}

/// Size of each of the scenes on a picture of `size` pixels in all, with the legend at its right.
pub fn panel_size(style: &Style, size: [u32; 2], count: usize, columns: usize) -> [u32; 2] {
    let [width, height] = size;
    let rows = count.div_ceil(columns.max(1)).max(1) as u32;
    let across = (width - style.legend_width(width, height)) / columns.max(1) as u32;
    [across.max(1), (height / rows).max(1)]
}

/// Draws scenes in rows of `columns`, `width` × `height` pixels in all. The camera looks at one of them, which is
/// of [`panel_size`].
///
/// # Errors
/// Where there is none, and what [`draw_scene`] says.
pub fn draw_worlds(
    renderer: &mut Renderer,
    panels: &[Panel<'_>],
    style: &Style,
    camera: &Camera,
    columns: usize,
    [width, height]: [u32; 2],
) -> Result<RgbaImage> {
    renderer.check_size(width, height)?;
    let Some(first) = panels.first() else {
        return Err(Error::value("worlds", "none", "at least one for a picture"));
    };
    let palette = style.theme.palette();
    let text_px = style.text_px(width, height);
    let [across, down] = panel_size(style, [width, height], panels.len(), columns);
    let bare = Style { legend: false, ..style.clone() };
    let mut whole = RgbaImage::from_pixel(width, height, palette.ground.to_rgba8());
    let words = TextStyle::new(text_px, palette.ink);
    let margin = (0.5 * text_px) as i64;
    for (index, panel) in panels.iter().enumerate() {
        // The scale is the same in all of them: one bar says it.
        let alone = Style { scale_bar: style.scale_bar && index == 0, ..bare.clone() };
        let mut image = draw_scene(renderer, panel.snapshot, &alone, camera, across, down)?;
        let room = across as f32 - 2.0 * margin as f32;
        let title = TextBlock::wrapped(panel.title, &words, room);
        title.draw(&mut image, margin, margin, Align::Start, Align::Start);
        let note = TextBlock::wrapped(panel.note, &words, room);
        let corner = [i64::from(across) - margin, i64::from(down) - margin];
        note.draw(&mut image, corner[0], corner[1], Align::End, Align::End);
        let (right, bottom) = (i64::from(across), i64::from(down));
        let line = palette.ground.mix(palette.ink, FRAME);
        fill(&mut image, right - 1, right, 0, bottom, line);
        fill(&mut image, 0, right, bottom - 1, bottom, line);
        let (column, row) = ((index % columns) as i64, (index / columns) as i64);
        imageops::replace(&mut whole, &image, column * right, row * bottom);
    }
    let strip_width = style.legend_width(width, height);
    if strip_width > 0 {
        let legend = Legend::of(first.snapshot, style, camera, text_px).draw(strip_width, height);
        imageops::replace(&mut whole, &legend, i64::from(width - strip_width), 0);
    }
    Ok(whole)
}
