//! The style of a picture: the quantity that the colours of the grains show, and the items that are drawn with the
//! grains.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::camera::Margins;
use super::{Camera, Colour};

/// Fraction by which the colours of grains are mixed with the colour of the background if contact forces are drawn on
/// the grains, 0 to 1.
const FADING: f32 = 0.62;
/// Height of the free space below the scene for the scale bar, in font sizes.
const SCALE_BAR_EM: f64 = 1.6;

/// The quantity that the colour of a grain shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum ColourBy {
    /// The grey that the scene gives each grain, as in the paper (Abramian & Staron, 2020).
    #[default]
    #[serde(rename = "grey")]
    #[value(name = "grey")]
    PaperGreys,
    /// Speed of the centre, m/s.
    Speed,
    /// Largest overlap over the grain's contacts, in mean diameters.
    Overlap,
    /// Sum of the magnitudes of the normal forces at the grain's contacts, N.
    Force,
    /// Number of the grain's contacts.
    Coordination,
    /// Material of the grain.
    Material,
}

impl ColourBy {
    /// True if the colours show a quantity with a continuous range and therefore need a scale.
    pub(crate) fn has_scale(self) -> bool {
        !matches!(self, Self::PaperGreys | Self::Coordination | Self::Material)
    }
}

/// Colours of the background, and of lines and text.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Theme {
    /// Dark lines and text on white, for print.
    #[default]
    Light,
    /// Light lines and text on a dark background, for screens.
    Dark,
}

/// The style of a picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Style {
    /// Quantity that the colours of the grains show.
    pub colour_by: ColourBy,
    /// Values at the two ends of the colour scale, in the units of [`ColourBy`]. If it is `None`, the range is chosen
    /// from the snapshot. All frames of an animation should have the same range.
    pub range: Option<(f64, f64)>,
    /// True if contact forces are drawn as lines, with paler grains below them.
    pub show_forces: bool,
    /// Magnitude of the normal contact force that is drawn as a line of full width, newtons. If it is `None`, the 95th
    /// percentile of the snapshot's forces is used.
    pub force_reference: Option<f64>,
    /// True if arrows show the velocities of the grains.
    pub show_velocities: bool,
    /// Speed that is drawn as an arrow of full length, m/s. If it is `None`, a round number above the speed of the
    /// fastest grain is used.
    pub speed_reference: Option<f64>,
    /// True if arrows show how walls and discs that are not grains move, and the forces that drive them.
    pub show_motions: bool,
    /// True if grains have an outline.
    pub outlines: bool,
    /// True if a line from the centre of each grain to its edge shows its angle.
    pub angles: bool,
    /// True if a scale bar is drawn.
    pub scale_bar: bool,
    /// True if a legend is drawn, provided that the colours, lines or arrows need an explanation.
    pub legend: bool,
    /// Colours of the background, and of lines and text.
    pub theme: Theme,
    /// Font size below which labels do not shrink in a small picture, pixels. Every picture has at least 10 pixels.
    #[serde(skip)]
    pub least_text_px: f32,
}

impl Default for Style {
    fn default() -> Self {
        Self {
            colour_by: ColourBy::PaperGreys,
            range: None,
            show_forces: false,
            force_reference: None,
            show_velocities: false,
            speed_reference: None,
            show_motions: true,
            outlines: true,
            angles: false,
            scale_bar: true,
            legend: true,
            theme: Theme::Light,
            least_text_px: 0.0,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Palette {
    pub ground: Colour,
    pub ink: Colour,
    pub outline: Colour,
    pub fixed: Colour,
    pub boundary: Colour,
    /// Colour of contact forces that push. Colour-blind people can distinguish it from `pull`, the colour of contact
    /// forces that pull (Okabe & Ito).
    pub push: Colour,
    pub pull: Colour,
}

impl Theme {
    pub(crate) const fn palette(self) -> Palette {
        match self {
            Self::Light => Palette {
                ground: Colour::WHITE,
                ink: Colour::grey(26),
                outline: Colour::grey(51),
                fixed: Colour::grey(120),
                boundary: Colour::grey(51),
                push: Colour::hex(0x0072b2),
                pull: Colour::hex(0xd55e00),
            },
            Self::Dark => Palette {
                ground: Colour::hex(0x14171c),
                ink: Colour::grey(230),
                // The outline is lighter than the low end of the colour map, which is as dark as the background.
                outline: Colour::grey(150),
                fixed: Colour::grey(95),
                boundary: Colour::grey(170),
                push: Colour::hex(0x56b4e9),
                pull: Colour::hex(0xe8772e),
            },
        }
    }
}

impl Style {
    /// Returns the font size of the labels, pixels, in a picture of `width` × `height` pixels.
    pub(crate) fn text_px(&self, width: u32, height: u32) -> f32 {
        // The font size is 16 px at 800 × 500. Larger pictures are viewed from a larger distance, but the distance
        // grows more slowly than the size.
        let side = f64::from(width).min(1.6 * f64::from(height));
        let usual = (16.0 * (side / 800.0).sqrt()).clamp(10.0, 48.0).round() as f32;
        usual.max(self.least_text_px)
    }

    /// Returns the fraction by which the colours of grains are mixed with the colour of the background, 0 to 1; it is
    /// above 0 if contact forces are drawn on the grains.
    pub(crate) fn fading(&self) -> f32 {
        if self.show_forces { FADING } else { 0.0 }
    }

    /// True if the style has a legend, and if its colours, lines or arrows need an explanation.
    pub(crate) fn has_legend(&self) -> bool {
        let needed =
            self.colour_by != ColourBy::PaperGreys || self.show_forces || self.show_velocities;
        self.legend && needed
    }

    /// Returns the width of the legend's strip on the right of the picture, pixels; 0 without a legend.
    pub(crate) fn legend_width(&self, width: u32, height: u32) -> u32 {
        let strip = (7.0 * self.text_px(width, height)).ceil() as u32;
        // A picture that is too narrow for scene and legend shows only the scene.
        if self.has_legend() && width > 2 * strip { strip } else { 0 }
    }

    /// Returns the camera that shows the box from `min` to `max` (m) as large as possible in a picture of `width` ×
    /// `height` pixels. Legend and scale bar have free space and cover no grain.
    pub fn camera(&self, min: DVec2, max: DVec2, width: u32, height: u32) -> Camera {
        let text = f64::from(self.text_px(width, height));
        let margin = text.min(0.05 * f64::from(width.min(height)));
        let bar = if self.scale_bar { SCALE_BAR_EM * text } else { 0.0 };
        let margins = Margins { left: margin, right: margin, top: margin, bottom: margin + bar };
        Camera::framing(min, max, width - self.legend_width(width, height), height, margins)
    }
}

#[cfg(test)]
mod tests {
    use clap::ValueEnum;

    use super::*;

    #[test]
    fn names_on_the_command_line_and_in_files_are_the_same() {
        for (value, name) in [
            (ColourBy::PaperGreys, "grey"),
            (ColourBy::Speed, "speed"),
            (ColourBy::Overlap, "overlap"),
            (ColourBy::Force, "force"),
            (ColourBy::Coordination, "coordination"),
            (ColourBy::Material, "material"),
        ] {
            assert_eq!(ColourBy::from_str(name, false), Ok(value));
            assert_eq!(serde_json::to_value(value).unwrap(), name);
        }
    }

    #[test]
    fn a_box_keeps_clear_of_legend_and_scale_bar() {
        let style = Style { colour_by: ColourBy::Speed, ..Style::default() };
        let (min, max) = (DVec2::ZERO, DVec2::new(2.0, 1.0));
        let camera = style.camera(min, max, 800, 500);
        let scene_width = 800 - style.legend_width(800, 500);
        let [right, _] = camera.project(max);
        let [_, bottom] = camera.project(min);
        assert!(right <= scene_width as f32 / 2.0 - 10.0);
        assert!(bottom >= -250.0 + 2.0 * 16.0);
    }
}
