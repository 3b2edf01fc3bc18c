//! From a snapshot to a picture: walls, fixed discs, grains, forces, marks, each one batch.

use glam::DVec2;

use super::arrows::velocity_links;
use super::borders::border_links;
use super::boundaries::boundary_links;
use super::colour_scale::ColourScale;
use super::font::TextStyle;
use super::forces::force_links;
use super::motions::motion_links;
use super::scale_bar::ScaleBar;
use super::{Camera, Colour, DiscInstance, LinkInstance, Palette, Picture, Style};
use crate::sim::{GrainView, Snapshot};
use crate::world::{Disc, Periodic};

/// How far the borders of a cell fade towards the ground.
const BORDER_FADING: f32 = 0.4;
/// Radius of the centre of attraction, as a part of the label's font size.
const CENTRE_RADIUS_EM: f32 = 0.28;

/// The picture of a snapshot, without words: see [`super::draw_scene`] for those. `width` and
/// `height` are those of the scene alone, without the legend's strip.
pub(crate) fn scene_picture(
    snapshot: &Snapshot,
    style: &Style,
    camera: &Camera,
    width: u32,
    height: u32,
) -> Picture {
    let palette = style.theme.palette();
    let surroundings = &snapshot.surroundings;
    let periodic = surroundings.periodic;
    let view = View { style, palette: &palette, camera, width, height, periodic };
    let mut picture = Picture::new(palette.ground);
    let text_px = style.text_px(width, height);

    picture.push_links(view.borders(text_px));
    let boundaries = &surroundings.boundaries;
    picture.push_links(boundary_links(
        boundaries,
        camera,
        width,
        height,
        text_px,
        palette.boundary,
    ));
    let fixed = surroundings.fixed_discs.iter();
    picture.push_discs(fixed.flat_map(|disc| view.fixed(disc)).collect());
    let scale = ColourScale::new(style, snapshot);
    let mean_diameter = surroundings.mean_diameter;
    let grains = snapshot.grains.iter();
    picture.push_discs(
        grains.flat_map(|grain| view.grain(grain, scale.colour(grain, mean_diameter))).collect(),
    );
    if style.show_forces {
        picture.push_links(force_links(snapshot, style, &palette, camera, width, height));
    }
    if style.show_velocities {
        picture.push_links(velocity_links(snapshot, style, palette.ink, camera, width, height));
    }
    if style.show_motions {
        picture.push_links(motion_links(surroundings, &palette, camera, [width, height], text_px));
    }
    if let Some(centre) = surroundings.centre_of_attraction {
        // The ring keeps the dot visible on a grain of its own colour.
        picture.push_discs(vec![DiscInstance {
            outline_width: 1.0,
            outline: palette.ground,
            ..DiscInstance::plain(
                camera.project(centre),
                CENTRE_RADIUS_EM * text_px + 1.0,
                palette.ink,
            )
        }]);
    }
    if style.scale_bar {
        let bar = ScaleBar::new(style, camera, width, height);
        let label_width = TextStyle::new(text_px, palette.ink).width(&bar.label);
        picture.push_links(bar.links(&palette, label_width));
    }
    picture
}

/// What all discs of a picture share.
struct View<'a> {
    style: &'a Style,
    palette: &'a Palette,
    camera: &'a Camera,
    width: u32,
    height: u32,
    periodic: Option<Periodic>,
}

impl View<'_> {
    /// The borders of the cell, where there is one.
    fn borders(&self, text_px: f32) -> Vec<LinkInstance> {
        let colour = self.palette.boundary.mix(self.palette.ground, BORDER_FADING);
        let size = [self.width, self.height];
        let links = |periodic| border_links(periodic, self.camera, size, text_px, colour);
        self.periodic.map(links).unwrap_or_default()
    }

    /// A fixed disc, with its images that reach into the cell.
    fn fixed(&self, disc: &Disc) -> impl Iterator<Item = DiscInstance> {
        let radius = disc.radius;
        let images = self.images(disc.position, radius);
        images.filter_map(move |place| self.disc(place, radius, 0.0, self.palette.fixed))
    }

    /// A grain, with its images that reach into the cell.
    fn grain(&self, grain: &GrainView, colour: Colour) -> impl Iterator<Item = DiscInstance> {
        let (radius, angle) = (grain.radius, grain.angle);
        let images = self.images(grain.position, radius);
        images.filter_map(move |place| {
            let mut disc = self.disc(place, radius, angle, colour)?;
            if self.style.angles {
                disc.mark_half_width = (0.04 * disc.radius).clamp(0.3, 1.25);
            }
            Some(disc)
        })
    }

    /// Where a disc is to be drawn: at its place, and a period on where it reaches over a border.
    fn images(&self, position: DVec2, radius: f64) -> impl Iterator<Item = DVec2> {
        let reach = [position - radius, position + radius];
        let images = self.periodic.into_iter().flat_map(move |periodic| periodic.images(reach));
        std::iter::once(DVec2::ZERO).chain(images).map(move |by| position + by)
    }

    /// A disc of the world, or none if it lies outside the picture.
    fn disc(
        &self,
        position: DVec2,
        radius: f64,
        angle: f64,
        colour: Colour,
    ) -> Option<DiscInstance> {
        let offset = self.camera.offset_px(position);
        let radius = self.camera.pixels(radius);
        let reach = DVec2::new(f64::from(self.width), f64::from(self.height)) / 2.0;
        // Written so that a position that is not a number is left out.
        let shows = offset.abs().cmplt(reach + f64::from(radius) + 1.0).all();
        let fade = |colour: Colour| colour.mix(self.palette.ground, self.style.fading());
        let outline_width = if self.style.outlines { (0.1 * radius).clamp(0.25, 1.5) } else { 0.0 };
        shows.then(|| DiscInstance {
            centre: offset.as_vec2().into(),
            radius,
            outline_width,
            mark_half_width: 0.0,
            direction: [angle.cos() as f32, angle.sin() as f32],
            fill: fade(colour),
            outline: fade(self.palette.outline),
        })
    }
}
