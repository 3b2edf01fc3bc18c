//! Colours in gamma space, the numbers that a PNG file stores divided by 255, and what they stand for.
//!
//! All blending happens on these numbers, on every renderer, so that pictures look the same everywhere and a
//! half-covered edge pixel is the plain mean of its two sides.

use serde::{Deserialize, Serialize};

use super::numbers::{round_above, si_prefix};
use super::{ColourBy, Style};
use crate::sim::{GrainView, Snapshot};

/// Red, green, blue and opacity, each 0 … 1, not premultiplied.
#[repr(C)]
#[cfg_attr(feature = "gpu", derive(bytemuck::Pod, bytemuck::Zeroable))]
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Colour {
    pub red: f32,
    pub green: f32,
    pub blue: f32,
    pub alpha: f32,
}

impl Colour {
    pub(crate) const WHITE: Self = Self::grey(255);
    #[cfg(test)]
    pub(crate) const BLACK: Self = Self::grey(0);

    /// The opaque colour that is written `#rrggbb` on the web.
    pub(crate) const fn hex(rrggbb: u32) -> Self {
        Self {
            red: ((rrggbb >> 16) & 0xff) as f32 / 255.0,
            green: ((rrggbb >> 8) & 0xff) as f32 / 255.0,
            blue: (rrggbb & 0xff) as f32 / 255.0,
            alpha: 1.0,
        }
    }

    /// An opaque grey: 0 black … 255 white.
    pub(crate) const fn grey(tone: u8) -> Self {
        let level = tone as f32 / 255.0;
        Self { red: level, green: level, blue: level, alpha: 1.0 }
    }

    pub(crate) const fn with_alpha(self, alpha: f32) -> Self {
        Self { alpha, ..self }
    }

    /// This colour at `part` 0, `other` at 1.
    pub(crate) fn mix(self, other: Self, part: f32) -> Self {
        let between = |a: f32, b: f32| a + (b - a) * part;
        Self {
            red: between(self.red, other.red),
            green: between(self.green, other.green),
            blue: between(self.blue, other.blue),
            alpha: between(self.alpha, other.alpha),
        }
    }

    /// Red, green and blue times opacity, and opacity.
    pub(super) fn premultiplied(self) -> [f32; 4] {
        let Self { red, green, blue, alpha } = self;
        [red * alpha, green * alpha, blue * alpha, alpha]
    }

    pub(crate) fn to_rgba8(self) -> image::Rgba<u8> {
        // Casts from float to integer saturate, so a channel outside 0 … 1 ends at 0 or 255.
        let byte = |channel: f32| (channel * 255.0 + 0.5) as u8;
        image::Rgba([byte(self.red), byte(self.green), byte(self.blue), byte(self.alpha)])
    }
}

/// Lays a colour over an opaque pixel, `coverage` 0 … 1 times its opacity.
pub(super) fn blend_pixel(pixel: &mut image::Rgba<u8>, colour: Colour, coverage: f32) {
    let alpha = colour.alpha * coverage;
    for (under, over) in pixel.0.iter_mut().zip([colour.red, colour.green, colour.blue]) {
        *under = (f32::from(*under) * (1.0 - alpha) + over * 255.0 * alpha + 0.5) as u8;
    }
}

/// Equally spaced along the map.
const VIRIDIS: [Colour; 9] = [
    Colour::hex(0x440154),
    Colour::hex(0x472d7b),
    Colour::hex(0x3b528b),
    Colour::hex(0x2c728e),
    Colour::hex(0x21918c),
    Colour::hex(0x28ae80),
    Colour::hex(0x5ec962),
    Colour::hex(0xaddc30),
    Colour::hex(0xfde725),
];

/// Numbers of contacts from here on share one colour.
pub(super) const MOST_CONTACTS: u32 = 6;

/// The colour at `part` of the map; what lies outside 0 … 1 takes the colour of the end.
pub(crate) fn map_colour(part: f64) -> Colour {
    // A value that is not a number would index nothing.
    let part = if part.is_nan() { 0.0 } else { part.clamp(0.0, 1.0) };
    let place = part * (VIRIDIS.len() - 1) as f64;
    let below = (place as usize).min(VIRIDIS.len() - 2);
    VIRIDIS[below].mix(VIRIDIS[below + 1], (place - below as f64) as f32)
}

/// A quantity and the values at the two ends of its colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ColourScale {
    pub colour_by: ColourBy,
    /// Value at the lower end, in the unit that [`ColourBy`] states.
    pub low: f64,
    pub high: f64,
}

impl ColourScale {
    /// The scale that a style asks for: its own range, or one that holds the whole snapshot.
    pub(crate) fn new(style: &Style, snapshot: &Snapshot) -> Self {
        let (low, high) = match (style.colour_by, style.range) {
            (ColourBy::Coordination, _) => (0.0, f64::from(MOST_CONTACTS)),
            (_, Some(range)) => range,
            (colour_by, None) => automatic_range(colour_by, snapshot),
        };
        Self { colour_by: style.colour_by, low, high }
    }

    /// The colour of a grain. `mean_diameter` in m.
    pub(crate) fn colour(&self, grain: &GrainView, mean_diameter: f64) -> Colour {
        match self.colour_by {
            ColourBy::PaperGreys => Colour::grey(grain.tone),
            ColourBy::Coordination => contact_colour(grain.coordination),
            _ => {
                let span = self.high - self.low;
                let above = quantity(self.colour_by, grain, mean_diameter) - self.low;
                map_colour(if span > 0.0 { above / span } else { 0.0 })
            }
        }
    }

    /// What the legend calls the quantity, and what its numbers are multiplied by.
    pub(crate) fn label(&self) -> (String, f64) {
        let (prefix, factor) = si_prefix(self.low.abs().max(self.high.abs()));
        match self.colour_by {
            ColourBy::PaperGreys => (String::new(), 1.0),
            ColourBy::Speed => (format!("speed ({prefix}m/s)"), 1.0 / factor),
            ColourBy::Overlap => ("overlap (% of d)".to_owned(), 100.0),
            ColourBy::Force => (format!("force ΣN ({prefix}N)"), 1.0 / factor),
            ColourBy::Coordination => ("contacts".to_owned(), 1.0),
        }
    }
}

pub(crate) fn contact_colour(contacts: u32) -> Colour {
    map_colour(f64::from(contacts.min(MOST_CONTACTS)) / f64::from(MOST_CONTACTS))
}

/// A range from zero to a round number that holds every grain of the snapshot. An animation takes
/// the largest over its frames.
pub(crate) fn automatic_range(colour_by: ColourBy, snapshot: &Snapshot) -> (f64, f64) {
    let mean_diameter = snapshot.surroundings.mean_diameter;
    let largest = snapshot
        .grains
        .iter()
        .map(|grain| quantity(colour_by, grain, mean_diameter))
        .filter(|value| value.is_finite())
        .fold(0.0, f64::max);
    // Nothing moves, overlaps or presses: any scale shows it at its lower end.
    let idle = if colour_by == ColourBy::Overlap { 0.01 } else { 1.0 };
    (0.0, if largest > 0.0 { round_above(largest) } else { idle })
}

fn quantity(colour_by: ColourBy, grain: &GrainView, mean_diameter: f64) -> f64 {
    match colour_by {
        ColourBy::PaperGreys => f64::from(grain.tone),
        ColourBy::Speed => grain.velocity.length(),
        ColourBy::Overlap => grain.overlap / mean_diameter,
        ColourBy::Force => grain.force,
        ColourBy::Coordination => f64::from(grain.coordination),
    }
}

#[cfg(test)]
mod tests {

    use super::*;

    #[test]
    fn hex_digits_become_bytes() {
        assert_eq!(Colour::hex(0xd55e00).to_rgba8().0, [0xd5, 0x5e, 0, 255]);
        assert_eq!(Colour::grey(205).to_rgba8().0, [205, 205, 205, 255]);
    }

    #[test]
    fn half_coverage_is_the_mean_in_gamma_space() {
        let mut pixel = Colour::WHITE.to_rgba8();
        blend_pixel(&mut pixel, Colour::BLACK, 0.5);
        assert_eq!(pixel.0, [128, 128, 128, 255]);
    }

    #[test]
    fn the_map_ends_at_its_ends() {
        assert_eq!(map_colour(-1.0), VIRIDIS[0]);
        assert_eq!(map_colour(f64::NAN), VIRIDIS[0]);
        assert_eq!(map_colour(0.5), VIRIDIS[4]);
        assert_eq!(map_colour(7.0).to_rgba8(), VIRIDIS[8].to_rgba8());
    }

    #[test]
    fn brightness_rises_along_the_map() {
        let brightness = |part: f64| {
            let colour = map_colour(part);
            0.2126 * colour.red.powf(2.2)
                + 0.7152 * colour.green.powf(2.2)
                + 0.0722 * colour.blue.powf(2.2)
        };
        assert!(
            (0..100)
                .all(|k| brightness(f64::from(k) / 100.0) < brightness(f64::from(k + 1) / 100.0))
        );
    }
}
