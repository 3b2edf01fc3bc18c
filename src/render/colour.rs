//! Colours as gamma-encoded values: the numbers that a PNG file stores, divided by 255.
//!
//! Every renderer blends these numbers, so that pictures look the same everywhere, and a pixel that is half on each
//! side of an edge has the mean colour of the two sides.

use serde::{Deserialize, Serialize};

/// A colour: red, green, blue and opacity, each 0 to 1. Red, green and blue are not multiplied by the opacity.
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

    /// Returns the opaque colour whose hexadecimal code is `rrggbb`, such as `0xff0000` for red.
    pub(crate) const fn hex(rrggbb: u32) -> Self {
        Self {
            red: ((rrggbb >> 16) & 0xff) as f32 / 255.0,
            green: ((rrggbb >> 8) & 0xff) as f32 / 255.0,
            blue: (rrggbb & 0xff) as f32 / 255.0,
            alpha: 1.0,
        }
    }

    /// Returns an opaque grey, from 0 (black) to 255 (white).
    pub(crate) const fn grey(tone: u8) -> Self {
        let level = tone as f32 / 255.0;
        Self { red: level, green: level, blue: level, alpha: 1.0 }
    }

    pub(crate) const fn with_alpha(self, alpha: f32) -> Self {
        Self { alpha, ..self }
    }

    /// Returns the linear interpolation between this colour (at `part` 0) and `other` (at `part` 1).
    pub(crate) fn mix(self, other: Self, part: f32) -> Self {
        let between = |a: f32, b: f32| a + (b - a) * part;
        Self {
            red: between(self.red, other.red),
            green: between(self.green, other.green),
            blue: between(self.blue, other.blue),
            alpha: between(self.alpha, other.alpha),
        }
    }

    /// Red, green and blue, each multiplied by the opacity, followed by the opacity.
    pub(super) fn premultiplied(self) -> [f32; 4] {
        let Self { red, green, blue, alpha } = self;
        [red * alpha, green * alpha, blue * alpha, alpha]
    }

    pub(crate) fn to_rgba8(self) -> image::Rgba<u8> {
        // Casts from float to integer saturate, so a channel below 0 or above 1 becomes 0 or 255.
        let byte = |channel: f32| (channel * 255.0 + 0.5) as u8;
        image::Rgba([byte(self.red), byte(self.green), byte(self.blue), byte(self.alpha)])
    }
}

/// Blends a colour over an opaque pixel. `coverage` is the fraction of the pixel that the shape covers, 0 to 1; the
/// opacity of the colour is multiplied by it.
pub(super) fn blend_pixel(pixel: &mut image::Rgba<u8>, colour: Colour, coverage: f32) {
    let alpha = colour.alpha * coverage;
    for (under, over) in pixel.0.iter_mut().zip([colour.red, colour.green, colour.blue]) {
        *under = (f32::from(*under) * (1.0 - alpha) + over * 255.0 * alpha + 0.5) as u8;
    }
}

/// Equally spaced colours of the colour map viridis, from its low end to its high end.
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

/// Colours of the materials of grains, which colour-blind people can distinguish (Okabe & Ito). The two colours that
/// also show contact forces come last.
pub(super) const MATERIALS: [Colour; 7] = [
    Colour::hex(0xe69f00),
    Colour::hex(0x56b4e9),
    Colour::hex(0x009e73),
    Colour::hex(0xcc79a7),
    Colour::hex(0xf0e442),
    Colour::hex(0x0072b2),
    Colour::hex(0xd55e00),
];

/// Returns the colour of the colour map viridis at the fraction `part` of its range, 0 to 1. Values outside this range
/// have the colour of the nearer end.
pub(crate) fn map_colour(part: f64) -> Colour {
    // NaN has the colour of 0.
    let part = if part.is_nan() { 0.0 } else { part.clamp(0.0, 1.0) };
    let place = part * (VIRIDIS.len() - 1) as f64;
    let below = (place as usize).min(VIRIDIS.len() - 2);
    VIRIDIS[below].mix(VIRIDIS[below + 1], (place - below as f64) as f32)
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
