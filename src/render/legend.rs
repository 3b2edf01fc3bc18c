//! The scale bar of a picture, and the strip on its right (the legend) that explains the colours of grains, the force
//! lines and the velocity arrows.
//!
//! The strip is always drawn on the processor, so that it is the same with every renderer.

use image::{RgbaImage, imageops};

use super::colour::map_colour;
use super::colour_scale::{ColourScale, MOST_CONTACTS, contact_colour, material_colour};
use super::numbers::{decimal, length, round_below, si_prefix, ticks};
use super::overlays::{force_reference, full_half_width_px, full_length, speed_reference};
use super::text::{Align, TextBlock, TextStyle};
use super::{Camera, Colour, ColourBy, LinkInstance, Palette, Picture, Style, primitives};
use crate::sim::Snapshot;

/// Longest scale bar, as a fraction of the picture's width.
const LONGEST: f64 = 0.2;

/// Position and label of a picture's scale bar.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ScaleBar {
    pub label: String,
    /// Left end of the bar, pixels, relative to the middle of the picture, y up.
    pub start: [f32; 2],
    pub end: [f32; 2],
    /// Font size of the label, pixels. The label starts half a font size to the right of `end`, the right end of the
    /// bar.
    pub text_px: f32,
}

impl ScaleBar {
    /// Returns the scale bar of a picture of `width` × `height` pixels.
    pub(crate) fn new(style: &Style, camera: &Camera, width: u32, height: u32) -> Self {
        let length_m = round_below(LONGEST * f64::from(width) * camera.metres_per_pixel);
        let text_px = style.text_px(width, height);
        let left = text_px - width as f32 / 2.0;
        let y = text_px - height as f32 / 2.0;
        let right = left + camera.pixels(length_m);
        Self { label: length(length_m), start: [left, y], end: [right, y], text_px }
    }

    /// Returns the thick lines of which the bar and its end marks consist. They lie on a rectangle in the colour of the
    /// background, which has space for a label that is `label_width` pixels wide.
    pub(super) fn links(&self, palette: &Palette, label_width: f32) -> Vec<LinkInstance> {
        let ([left, y], [right, _]) = (self.start, self.end);
        let half_width = (self.text_px / 16.0).max(0.75);
        let mark = 0.3 * self.text_px;
        let link = |start, end, half_width, colour| LinkInstance { start, end, half_width, colour };
        let plate = link(
            [left, y],
            [right + 0.5 * self.text_px + label_width, y],
            0.75 * self.text_px,
            palette.ground.with_alpha(0.85),
        );
        let ink = palette.ink;
        vec![
            plate,
            link([left, y], [right, y], half_width, ink),
            link([left, y - mark], [left, y + mark], half_width, ink),
            link([right, y - mark], [right, y + mark], half_width, ink),
        ]
    }
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Legend {
    pub scale: ColourScale,
    /// Names of the materials of the grains.
    pub materials: Vec<String>,
    /// Fraction by which the colours of grains are mixed with the colour of the background, 0 to 1.
    pub fading: f32,
    /// The magnitude of the normal contact force that a line of full width shows, newtons, and half of that width,
    /// pixels; `None` if forces are not drawn.
    pub forces: Option<(f64, f32)>,
    /// The speed of the example arrow in the legend, m/s, and the length of this arrow, pixels; `None` if velocities
    /// are not drawn.
    pub velocities: Option<(f64, f32)>,
    pub palette: Palette,
    pub text_px: f32,
}

impl Legend {
    /// Returns the legend of a snapshot in a style. `text_px` is the font size of the whole picture, pixels.
    pub(crate) fn of(snapshot: &Snapshot, style: &Style, camera: &Camera, text_px: f32) -> Self {
        let mean_diameter = snapshot.surroundings.mean_diameter;
        let forces =
            || (force_reference(style, snapshot), full_half_width_px(mean_diameter, camera));
        let arrow = || (speed_reference(style, snapshot), camera.pixels(full_length(snapshot)));
        Self {
            scale: ColourScale::new(style, snapshot),
            materials: snapshot.surroundings.materials.iter().map(|it| it.name.clone()).collect(),
            fading: style.fading(),
            forces: style.show_forces.then(forces),
            velocities: style.show_velocities.then(arrow),
            palette: style.theme.palette(),
            text_px,
        }
    }

    pub(crate) fn draw(&self, width: u32, height: u32) -> RgbaImage {
        let mut strip = RgbaImage::from_pixel(width, height, self.palette.ground.to_rgba8());
        let mut bottom = i64::from(height) - self.em(1.0);
        if let Some((reference, half_width)) = self.forces {
            bottom = self.draw_force_key(&mut strip, bottom, reference, half_width);
        }
        if let Some((speed, length)) = self.velocities {
            bottom = self.draw_arrow_key(&mut strip, bottom, speed, length);
        }
        let top = self.em(1.0);
        match self.scale.colour_by {
            ColourBy::PaperGreys => {}
            ColourBy::Coordination => {
                let swatch = |contacts: u32| {
                    let least = if contacts == MOST_CONTACTS { "≥ " } else { "" };
                    (contact_colour(contacts), format!("{least}{contacts}"))
                };
                let numbers = (0..MOST_CONTACTS + 1).rev();
                self.draw_swatches(&mut strip, top, bottom, numbers.map(swatch));
            }
            ColourBy::Material => {
                let names = self.materials.iter().cloned().enumerate();
                let swatches = names.map(|(number, name)| (material_colour(number), name));
                self.draw_swatches(&mut strip, top, bottom, swatches);
            }
            _ => self.draw_bar(&mut strip, top, bottom),
        }
        strip
    }

    fn em(&self, sizes: f32) -> i64 {
        (sizes * self.text_px).round() as i64
    }

    /// Returns a grain's colour as it appears in the picture, mixed with the colour of the background.
    fn faded(&self, colour: Colour) -> Colour {
        colour.mix(self.palette.ground, self.fading)
    }

    fn text(&self) -> TextStyle {
        TextStyle::new(self.text_px, self.palette.ink)
    }

    /// Draws a continuous colour bar with ticks and numbers on its right. The vertical title is to the right of the
    /// numbers.
    fn draw_bar(&self, strip: &mut RgbaImage, top: i64, bottom: i64) {
        let (left, right) = (self.em(0.4), self.em(1.5));
        let rows = bottom - top;
        if rows < self.em(3.0) {
            return;
        }
        for row in 0..rows {
            let part = 1.0 - (row as f64 + 0.5) / rows as f64;
            fill(strip, left, right, top + row, top + row + 1, self.faded(map_colour(part)));
        }
        let (title, factor) = self.scale.label();
        let (low, high) = (self.scale.low * factor, self.scale.high * factor);
        let most = (rows / self.em(2.0)).clamp(2, 6) as usize;
        let (values, step) = ticks(low, high, most);
        let span = (self.scale.high - self.scale.low) * factor;
        let mut widest = 0;
        for value in values {
            let part = if span > 0.0 { (value - low) / span } else { 0.0 };
            // The centres of the first and the last tick are on the bar.
            let y = bottom - 1 - (part * (rows - 1) as f64).round() as i64;
            fill(strip, right, right + self.em(0.3), y, y + 1, self.palette.ink);
            let label = TextBlock::new(&decimal(value, step), &self.text());
            widest = widest.max(i64::from(label.width()));
            label.draw(strip, right + self.em(0.4), y, Align::Start, Align::Centre);
        }
        self.draw_title(strip, &title, rows, right + self.em(0.5) + widest, (top + bottom) / 2);
    }

    /// Draws one square per colour with its label, from top to bottom. The vertical title is to the right of the
    /// labels.
    fn draw_swatches(
        &self,
        strip: &mut RgbaImage,
        top: i64,
        bottom: i64,
        swatches: impl ExactSizeIterator<Item = (Colour, String)>,
    ) {
        let count = (swatches.len() as i64).max(1);
        let pitch = self.em(1.8).min((bottom - top) / count);
        if pitch < 3 {
            return;
        }
        let (left, right) = (self.em(0.4), self.em(1.5));
        let start = (top + bottom - count * pitch) / 2;
        let mut widest = 0;
        for (place, (colour, label)) in (0..).zip(swatches) {
            let y = start + place * pitch;
            fill(strip, left, right, y, y + pitch, self.faded(colour));
            let label = TextBlock::new(&label, &self.text());
            widest = widest.max(i64::from(label.width()));
            label.draw(strip, right + self.em(0.4), y + pitch / 2, Align::Start, Align::Centre);
        }
        let (title, x) = (self.scale.label().0, right + self.em(0.5) + widest);
        self.draw_title(strip, &title, count * pitch, x, start + count * pitch / 2);
    }

    /// Draws the explanation of contact forces: the colours of pull and push, and the force that a line of full width
    /// shows. Returns the y position of its upper end, pixels.
    fn draw_force_key(
        &self,
        strip: &mut RgbaImage,
        bottom: i64,
        reference: f64,
        half_width: f32,
    ) -> i64 {
        let largest = i64::from(strip.width()) - self.em(0.8);
        let (prefix, factor) = si_prefix(reference);
        let value = reference / factor;
        let step = round_below(value.abs().max(1e-9)) / 10.0;
        let widest = format!("widest line:\n{} {prefix}N", decimal(value, step));
        let note = TextBlock::wrapped(&widest, &self.text(), largest as f32);
        let mut y = bottom - i64::from(note.height());
        // Before the first step no force is known.
        if reference > 0.0 {
            note.draw(strip, self.em(0.4), y, Align::Start, Align::Start);
        }
        for (name, colour) in [("pull", self.palette.pull), ("push", self.palette.push)] {
            y -= self.em(1.5);
            let middle = y + self.em(0.75);
            self.sample(strip, middle, half_width.min(0.55 * self.text_px), colour);
            let label = TextBlock::new(name, &self.text());
            label.draw(strip, self.em(2.9), middle, Align::Start, Align::Centre);
        }
        y - self.em(1.2)
    }

    /// Draws the explanation of velocities: an arrow with the speed that it shows. Returns the y position of its upper
    /// end, pixels.
    fn draw_arrow_key(&self, strip: &mut RgbaImage, bottom: i64, speed: f64, length: f32) -> i64 {
        let largest = (strip.width() as f32 - 2.0 * self.text_px).max(1.0);
        // If the arrow is too long, its length and its speed are halved until it fits.
        let halvings = (length / largest).log2().ceil().max(0.0);
        let (speed, length) = (speed / f64::from(halvings.exp2()), length / halvings.exp2());
        let (prefix, factor) = si_prefix(speed);
        let step = round_below((speed / factor).abs().max(1e-9)) / 10.0;
        let note = format!("{} {prefix}m/s", decimal(speed / factor, step));
        let note =
            TextBlock::wrapped(&note, &self.text(), strip.width() as f32 - 0.8 * self.text_px);
        let mut y = bottom - i64::from(note.height());
        note.draw(strip, self.em(0.4), y, Align::Start, Align::Start);
        if speed > 0.0 {
            y -= self.em(1.2);
            let [width, height] = [strip.width(), self.em(1.2).max(1) as u32];
            let mut picture = Picture::new(self.palette.ground);
            let left = self.em(0.6) as f32 - width as f32 / 2.0;
            let tip = left + length;
            let barb = 0.35 * self.text_px;
            let link = |from, to| LinkInstance {
                start: from,
                end: to,
                half_width: (0.05 * self.text_px).max(0.6),
                colour: self.palette.ink,
            };
            picture.push_links(vec![
                link([left, 0.0], [tip, 0.0]),
                link([tip, 0.0], [tip - barb, 0.6 * barb]),
                link([tip, 0.0], [tip - barb, -0.6 * barb]),
            ]);
            imageops::replace(strip, &primitives::draw(&picture, width, height), 0, y);
        }
        y - self.em(0.8)
    }

    /// Draws a short line at the left of the legend's strip, as an example of a contact force.
    fn sample(&self, strip: &mut RgbaImage, y: i64, half_width: f32, colour: Colour) {
        let [width, height] = [self.em(2.4), self.em(1.4)].map(|side| side.max(1) as u32);
        let mut picture = Picture::new(self.palette.ground);
        let end = (width as f32 / 2.0 - half_width - 1.0).max(0.0);
        picture.push_links(vec![LinkInstance {
            start: [-end, 0.0],
            end: [end, 0.0],
            half_width,
            colour,
        }]);
        let sample = primitives::draw(&picture, width, height);
        imageops::replace(strip, &sample, self.em(0.2), y - i64::from(height / 2));
    }

    /// Draws the title on one line that runs upwards, starting at (`x`, `y`), pixels. If the title would be longer than
    /// the colour bar, its font size is reduced.
    fn draw_title(&self, strip: &mut RgbaImage, title: &str, length: i64, x: i64, y: i64) {
        let style = self.text();
        let shrink = (length as f32 / style.width(title).max(1.0)).min(1.0);
        let style = TextStyle { size_px: style.size_px * shrink, ..style };
        TextBlock::new(title, &style).turned().draw(strip, x, y, Align::Start, Align::Centre);
    }
}

/// Fills the part of a rectangle that is inside the image with one colour.
pub(super) fn fill(
    image: &mut RgbaImage,
    left: i64,
    right: i64,
    top: i64,
    bottom: i64,
    colour: Colour,
) {
    let (width, height) = image.dimensions();
    let clamp = |at: i64, limit: u32| at.clamp(0, i64::from(limit)) as u32;
    for y in clamp(top, height)..clamp(bottom, height) {
        for x in clamp(left, width)..clamp(right, width) {
            image.put_pixel(x, y, colour.to_rgba8());
        }
    }
}

#[cfg(test)]
mod tests {

    use super::*;
    use glam::DVec2;

    #[test]
    fn the_bar_is_round_and_fits() {
        for metres_per_pixel in [1e-6, 3.3e-5, 1.7e-4, 0.02, 5.0] {
            let camera = Camera { centre: DVec2::ZERO, metres_per_pixel };
            let bar = ScaleBar::new(&Style::default(), &camera, 800, 500);
            let pixels = bar.end[0] - bar.start[0];
            assert!((63.0..=160.1).contains(&pixels), "{pixels} px at {metres_per_pixel} m/px");
            let digits = bar.label.split(' ').next().unwrap().trim_end_matches('0');
            assert!(["1", "2", "5"].contains(&digits), "{}", bar.label);
        }
    }
}
