//! Words on finished pictures, set on the processor so that they are the same on every renderer.
//!
//! A [`TextBlock`] is laid out once, as a mask of pixel coverage, and can then be measured, turned
//! and drawn anywhere.

use image::RgbaImage;

use super::align::Align;
use super::colour::{Colour, blend_pixel};
use super::font::TextStyle;

/// Text laid out: a mask of pixel coverage and a colour.
#[derive(Clone, Debug)]
pub(crate) struct TextBlock {
    width: u32,
    height: u32,
    /// 0 … 1, row by row.
    coverage: Vec<f32>,
    colour: Colour,
}

impl TextBlock {
    /// Lays text out; `\n` ends a line, `_{…}` lowers letters and `^{…}` raises them.
    pub(crate) fn new(text: &str, style: &TextStyle) -> Self {
        let lines: Vec<&str> = text.split('\n').collect();
        let widest = lines.iter().map(|line| style.width(line)).fold(0.0, f32::max);
        // Slanted and accented letters may reach a pixel beyond their advance.
        let width = widest.ceil() as u32 + 2;
        let height = (style.line_height() * lines.len() as f32).ceil() as u32;
        let coverage = vec![0.0; width as usize * height as usize];
        let mut block = Self { width, height, coverage, colour: style.colour };
        for (index, line) in lines.iter().enumerate() {
            let free = (widest - style.width(line)) as u32;
            let left = 1.0 + style.lines.share(free) as f32;
            let baseline = style.line_height() * index as f32 + style.ascent();
            block.set_line(line, style, left, baseline);
        }
        block
    }

    /// Lays text out, breaking lines at spaces so that none is wider than `largest_width_px`. If a
    /// single word is wider, the text becomes smaller.
    pub(crate) fn wrapped(text: &str, style: &TextStyle, largest_width_px: f32) -> Self {
        // A block is up to three pixels wider than its longest line.
        let largest = (largest_width_px - 3.0).max(1.0);
        let widest_word = text.split_whitespace().map(|word| style.width(word)).fold(0.0, f32::max);
        let shrink = (largest / widest_word.max(1.0)).min(1.0);
        let style = TextStyle { size_px: style.size_px * shrink, ..*style };
        let mut wrapped = String::new();
        for paragraph in text.split('\n') {
            let mut line = String::new();
            for word in paragraph.split_whitespace() {
                let longer =
                    if line.is_empty() { word.to_owned() } else { format!("{line} {word}") };
                if !line.is_empty() && style.width(&longer) > largest {
                    wrapped.push_str(&line);
                    wrapped.push('\n');
                    line = word.to_owned();
                } else {
                    line = longer;
                }
            }
            wrapped.push_str(&line);
            wrapped.push('\n');
        }
        wrapped.pop();
        Self::new(&wrapped, &style)
    }

    fn set_line(&mut self, line: &str, style: &TextStyle, left: f32, baseline: f32) {
        for glyph in style.set(line).0 {
            if let Some(shape) = style.shape(glyph, left, baseline.round()) {
                let corner = shape.px_bounds().min;
                let (x, y) = (corner.x as i64, corner.y as i64);
                shape.draw(|right, down, coverage| {
                    self.cover(x + i64::from(right), y + i64::from(down), coverage);
                });
            }
        }
    }

    fn cover(&mut self, x: i64, y: i64, coverage: f32) {
        if (0..i64::from(self.width)).contains(&x) && (0..i64::from(self.height)).contains(&y) {
            let cell = &mut self.coverage[y as usize * self.width as usize + x as usize];
            *cell = (*cell + coverage).min(1.0);
        }
    }

    /// Width, pixels.
    pub(crate) fn width(&self) -> u32 {
        self.width
    }

    /// Height, pixels.
    pub(crate) fn height(&self) -> u32 {
        self.height
    }

    /// Part of the block that ink covers, 0 … 1.
    #[cfg(test)]
    pub(crate) fn ink(&self) -> f32 {
        self.coverage.iter().sum::<f32>() / self.coverage.len().max(1) as f32
    }

    /// Turned by 90° anticlockwise: reads upwards, as the label of a vertical axis.
    pub(crate) fn turned(&self) -> Self {
        let (width, height) = (self.height, self.width);
        let mut coverage = Vec::with_capacity(self.coverage.len());
        for row in 0..height {
            for column in 0..width {
                let (x, y) = (self.width - 1 - row, column);
                coverage.push(self.coverage[(y * self.width + x) as usize]);
            }
        }
        Self { width, height, coverage, colour: self.colour }
    }

    /// Draws the block at the point (`x`, `y`), pixels from the upper left corner. What lies
    /// outside the image is left out.
    pub(crate) fn draw(&self, image: &mut RgbaImage, x: i64, y: i64, across: Align, down: Align) {
        let left = x - i64::from(across.share(self.width));
        let top = y - i64::from(down.share(self.height));
        for (index, coverage) in self.coverage.iter().enumerate() {
            let column = left + (index % self.width as usize) as i64;
            let row = top + (index / self.width as usize) as i64;
            let inside = u32::try_from(column).ok().zip(u32::try_from(row).ok());
            if let Some(pixel) =
                inside.and_then(|(column, row)| image.get_pixel_mut_checked(column, row))
                && *coverage > 0.0
            {
                blend_pixel(pixel, self.colour, *coverage);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrapped_lines_keep_their_width() {
        let style = TextStyle::new(16.0, Colour::BLACK);
        let block = TextBlock::wrapped("one two three four five six seven", &style, 90.0);
        assert!(block.width() <= 90 && block.height() > 32);
        let long = TextBlock::wrapped("incomprehensibilities", &style, 60.0);
        let line = TextBlock::new("incomprehensibilities", &style);
        assert!(long.width() <= 60 && long.height() < line.height(), "one line, smaller");
    }

    #[test]
    fn four_turns_change_nothing() {
        let block = TextBlock::new("Δt", &TextStyle::new(18.0, Colour::BLACK));
        let turned = block.turned();
        assert_eq!((turned.width(), turned.height()), (block.height(), block.width()));
        assert_eq!(turned.turned().turned().turned().coverage, block.coverage);
    }

    #[test]
    fn text_outside_the_image_is_left_out() {
        let mut image = RgbaImage::from_pixel(10, 10, Colour::WHITE.to_rgba8());
        let block = TextBlock::new("wide words", &TextStyle::new(20.0, Colour::BLACK));
        block.draw(&mut image, -5, -5, Align::Start, Align::Start);
        block.draw(&mut image, 8, 8, Align::Start, Align::Centre);
        assert!(image.pixels().any(|pixel| pixel.0[0] < 100));
    }
}
