//! Drawing of a snapshot as a finished picture: first the shapes, then the text, then the legend's strip. Several
//! scenes can also be drawn side by side.

use glam::DVec2;
use image::{RgbaImage, imageops};

use super::camera::half_size;
use super::colour_scale::ColourScale;
use super::legend::{Legend, ScaleBar, fill};
use super::overlays::{force_links, motion_links, velocity_links};
use super::text::{Align, TextBlock, TextStyle};
use super::walls::{border_links, boundary_links};
use super::{Camera, Colour, DiscInstance, Picture, Renderer, Style};
use crate::error::{Error, Result};
use crate::sim::Snapshot;

/// Draws a snapshot with scale bar and legend as a picture of `width` × `height` pixels. The camera describes the part
/// of the picture to the left of the legend; [`Style::camera`] returns a suitable camera.
///
/// # Errors
/// If a side of the picture has 0 pixels or is too long for the renderer, the error names `size`. Other errors have the
/// message of the graphics device.
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

/// Opacity of the lines between scenes that are drawn side by side, 0 to 1.
const FRAME: f32 = 0.25;

/// One scene of a picture that shows several scenes side by side.
#[derive(Clone, Copy, Debug)]
pub struct WorldPanel<'a> {
    /// The displayed snapshot.
    pub snapshot: &'a Snapshot,
    /// Title of the scene, in its upper left corner.
    pub title: &'a str,
    /// Result of the simulation, such as its slump, in the lower right corner.
    pub note: &'a str,
}

/// Returns width and height of each of `count` scenes, pixels, in a picture of `size` pixels that has the legend on its
/// right and `columns` scenes per row.
pub fn panel_size(style: &Style, size: [u32; 2], count: usize, columns: usize) -> [u32; 2] {
    let [width, height] = size;
    let rows = count.div_ceil(columns.max(1)).max(1) as u32;
    let across = (width - style.legend_width(width, height)) / columns.max(1) as u32;
    [across.max(1), (height / rows).max(1)]
}

/// Draws several scenes with their titles and results, in rows of `columns` scenes, as a picture of `width` × `height`
/// pixels. The camera describes a single scene of the size [`panel_size`].
///
/// # Errors
/// If the list of scenes is empty, and the errors of [`draw_scene`].
pub fn draw_worlds(
    renderer: &mut Renderer,
    panels: &[WorldPanel<'_>],
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
    let write = |image: &mut RgbaImage, panel: &WorldPanel<'_>| {
        let room = across as f32 - 2.0 * margin as f32;
        let title = TextBlock::wrapped(panel.title, &words, room);
        title.draw(image, margin, margin, Align::Start, Align::Start);
        let note = TextBlock::wrapped(panel.note, &words, room);
        let corner = [i64::from(across) - margin, i64::from(down) - margin];
        note.draw(image, corner[0], corner[1], Align::End, Align::End);
    };
    if panels.len() == 1 {
        let mut image = draw_scene(renderer, first.snapshot, style, camera, width, height)?;
        write(&mut image, first);
        return Ok(image);
    }
    for (index, panel) in panels.iter().enumerate() {
        // All scenes have the same scale, so only the first has a scale bar.
        let alone = Style { scale_bar: style.scale_bar && index == 0, ..bare.clone() };
        let mut image = draw_scene(renderer, panel.snapshot, &alone, camera, across, down)?;
        write(&mut image, panel);
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

/// Fraction by which the colour of periodic borders is mixed with the colour of the background, 0 to 1.
const BORDER_FADING: f32 = 0.4;
/// Radius of the dot that marks the centre of an attracting gravity field, in font sizes of the labels.
const CENTRE_RADIUS_EM: f32 = 0.28;

/// Returns the shapes of a snapshot as a picture without text, which [`super::draw_scene`] adds. `width` and `height`
/// are the size of the scene without the legend's strip, pixels.
pub(crate) fn scene_picture(
    snapshot: &Snapshot,
    style: &Style,
    camera: &Camera,
    width: u32,
    height: u32,
) -> Picture {
    let palette = style.theme.palette();
    let surroundings = &snapshot.surroundings;
    let mean_diameter = surroundings.mean_diameter;
    let size = [width, height];
    let mut picture = Picture::new(palette.ground);
    let text_px = style.text_px(width, height);

    if let Some(periodic) = surroundings.periodic {
        let colour = palette.boundary.mix(palette.ground, BORDER_FADING);
        picture.push_links(border_links(periodic, camera, size, text_px, colour));
    }
    let boundaries = &surroundings.boundaries;
    picture.push_links(boundary_links(boundaries, camera, size, text_px, palette.boundary));
    let placed = |position: DVec2, radius: f64, angle: f64, colour: Colour| {
        // A disc that extends beyond a periodic border is also drawn one period away.
        let reach = [position - radius, position + radius];
        let periodic = surroundings.periodic.into_iter();
        let images = periodic.flat_map(move |periodic| periodic.images(reach));
        let moves = std::iter::once(DVec2::ZERO).chain(images);
        moves.filter_map(move |by| disc(style, camera, size, position + by, radius, angle, colour))
    };
    let fixed = surroundings.fixed_discs.iter();
    let fixed = fixed.flat_map(|it| placed(it.position, it.radius, 0.0, palette.fixed));
    picture.push_discs(fixed.collect());
    let scale = ColourScale::new(style, snapshot);
    let grains = snapshot.grains.iter().flat_map(|grain| {
        let colour = scale.colour(grain, mean_diameter);
        placed(grain.position, grain.radius, grain.angle, colour)
    });
    let mark = |radius: f32| if style.angles { (0.04 * radius).clamp(0.3, 1.25) } else { 0.0 };
    let grains = grains.map(|it| DiscInstance { mark_half_width: mark(it.radius), ..it });
    picture.push_discs(grains.collect());
    if style.show_forces {
        picture.push_links(force_links(snapshot, style, &palette, camera, size));
    }
    if style.show_velocities {
        picture.push_links(velocity_links(snapshot, style, palette.ink, camera, size));
    }
    if style.show_motions {
        picture.push_links(motion_links(surroundings, &palette, camera, size, text_px));
    }
    if let Some(centre) = surroundings.centre_of_attraction {
        let radius = CENTRE_RADIUS_EM * text_px + 1.0;
        let dot = DiscInstance::plain(camera.project(centre), radius, palette.ink);
        // The ring in the colour of the background keeps the dot visible on a grain of the dot's colour.
        picture.push_discs(vec![DiscInstance {
            outline_width: 1.0,
            outline: palette.ground,
            ..dot
        }]);
    }
    if style.scale_bar {
        let bar = ScaleBar::new(style, camera, width, height);
        let label_width = TextStyle::new(text_px, palette.ink).width(&bar.label);
        picture.push_links(bar.links(&palette, label_width));
    }
    picture
}

/// Returns a disc of the scene as a shape in pixels, or `None` if it is outside a picture of `size` pixels.
fn disc(
    style: &Style,
    camera: &Camera,
    size: [u32; 2],
    position: DVec2,
    radius: f64,
    angle: f64,
    colour: Colour,
) -> Option<DiscInstance> {
    let offset = camera.offset_px(position);
    let radius = camera.pixels(radius);
    // Every comparison with NaN is false, so a NaN position is left out.
    let shows = offset.abs().cmplt(half_size(size) + f64::from(radius) + 1.0).all();
    let palette = style.theme.palette();
    let fade = |colour: Colour| colour.mix(palette.ground, style.fading());
    shows.then(|| DiscInstance {
        centre: offset.as_vec2().into(),
        radius,
        outline_width: if style.outlines { (0.1 * radius).clamp(0.25, 1.5) } else { 0.0 },
        mark_half_width: 0.0,
        direction: [angle.cos() as f32, angle.sin() as f32],
        fill: fade(colour),
        outline: fade(palette.outline),
    })
}
