//! Draws lines with the same width for every slope. The crate plotters fills lines as polygons with whole-pixel
//! corners, so a line of three pixels may become two or four pixels wide. Here each pixel is coloured in proportion to
//! the part of its area that the line covers.

use std::collections::BTreeMap;

use glam::DVec2;
use plotters::prelude::{BitMapBackend, DrawingBackend};
use plotters_backend::{BackendColor, BackendCoord, BackendStyle, DrawingErrorKind};

/// A bitmap backend that draws lines with the same width for every slope.
pub(super) struct EvenLines<'a>(pub BitMapBackend<'a>);

type Outcome<'a> = Result<(), DrawingErrorKind<<BitMapBackend<'a> as DrawingBackend>::ErrorType>>;

impl<'a> DrawingBackend for EvenLines<'a> {
    type ErrorType = <BitMapBackend<'a> as DrawingBackend>::ErrorType;

    fn get_size(&self) -> (u32, u32) {
        self.0.get_size()
    }

    fn ensure_prepared(&mut self) -> Outcome<'a> {
        self.0.ensure_prepared()
    }

    fn present(&mut self) -> Outcome<'a> {
        self.0.present()
    }

    fn draw_pixel(&mut self, point: BackendCoord, colour: BackendColor) -> Outcome<'a> {
        self.0.draw_pixel(point, colour)
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        upper_left: BackendCoord,
        lower_right: BackendCoord,
        style: &S,
        fill: bool,
    ) -> Outcome<'a> {
        self.0.draw_rect(upper_left, lower_right, style, fill)
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Outcome<'a> {
        let path: Vec<BackendCoord> = path.into_iter().collect();
        for (at, part) in covered(&path, f64::from(style.stroke_width())) {
            self.0.draw_pixel(at, style.color().mix(part))?;
        }
        Ok(())
    }
}

/// Returns the pixels of a line with this `width` (pixels) along `path`, each with the approximate fraction of its area
/// that the line covers. The fraction is one half for a pixel whose centre is on the edge of the line.
fn covered(path: &[BackendCoord], width: f64) -> BTreeMap<BackendCoord, f64> {
    let place = |(x, y): BackendCoord| DVec2::new(f64::from(x), f64::from(y));
    let reach = (0.5 * width + 1.0).ceil() as i32;
    let mut parts = BTreeMap::new();
    for pair in path.windows(2) {
        let (from, to) = (place(pair[0]), place(pair[1]));
        let (along, squared) = (to - from, from.distance_squared(to));
        let ends = |from: i32, to: i32| from.min(to) - reach..=from.max(to) + reach;
        for x in ends(pair[0].0, pair[1].0) {
            for y in ends(pair[0].1, pair[1].1) {
                let off = place((x, y)) - from;
                let nearest =
                    if squared > 0.0 { (off.dot(along) / squared).clamp(0.0, 1.0) } else { 0.0 };
                let distance = (off - nearest * along).length();
                let part = (0.5 * width + 0.5 - distance).clamp(0.0, 1.0);
                if part > 0.0 {
                    let known: &mut f64 = parts.entry((x, y)).or_default();
                    *known = known.max(part);
                }
            }
        }
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the mean width of a drawn line from the origin to `to`, pixels: the sum of the covered fractions of
    /// pixels, without the round ends of the line, divided by the length of the line.
    fn mean_width(to: BackendCoord, width: f64) -> f64 {
        let area: f64 = covered(&[(0, 0), to], width).values().sum();
        let length = f64::from(to.0).hypot(f64::from(to.1));
        (area - std::f64::consts::PI * (0.5 * width).powi(2)) / length
    }

    #[test]
    fn lines_are_as_wide_at_every_slope() {
        for width in [1.0, 2.0, 3.0] {
            for to in [(200, 0), (0, 200), (200, 3), (200, 40), (200, 100), (190, 200), (1, 200)] {
                let found = mean_width(to, width);
                assert!((found / width - 1.0).abs() < 0.05, "{found} of {width} to {to:?}");
            }
        }
    }
}
