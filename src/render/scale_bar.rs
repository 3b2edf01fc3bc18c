//! A bar of a round length at the lower left, with the length written beside it.

use super::numbers::{length, round_below};
use super::{Camera, LinkInstance, Palette, Style};

/// Longest bar, as a part of the picture's width.
const LONGEST: f64 = 0.2;

/// Where the scale bar of a picture lies, and what it says.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ScaleBar {
    /// Length shown, m.
    pub length: f64,
    /// The length as people write it.
    pub label: String,
    /// Left end, pixels from the middle of the picture, y up.
    pub start: [f32; 2],
    /// Right end.
    pub end: [f32; 2],
    /// Font size of the label, pixels; the label starts half of it to the right of `end`.
    pub text_px: f32,
}

impl ScaleBar {
    /// The bar for a picture of `width` × `height` pixels.
    pub(crate) fn new(style: &Style, camera: &Camera, width: u32, height: u32) -> Self {
        let length_m = round_below(LONGEST * f64::from(width) * camera.metres_per_pixel);
        let text_px = style.text_px(width, height);
        let left = text_px - width as f32 / 2.0;
        let y = text_px - height as f32 / 2.0;
        let right = left + camera.pixels(length_m);
        Self {
            length: length_m,
            label: length(length_m),
            start: [left, y],
            end: [right, y],
            text_px,
        }
    }

    /// Bar and end marks, on a plate of the ground's colour that `label_width` pixels of text fit on.
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
