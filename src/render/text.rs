//! Text on finished pictures. It is drawn on the processor, so that it is the same with every renderer.
//!
//! A [`TextBlock`] is laid out once, as a mask: the fraction of each pixel that letters cover. It can then be measured,
//! turned and drawn at any position. The font DejaVu Sans Condensed is free and has the Greek letters, superscripts and
//! signs that physics needs. The font is part of the program, so that text looks the same on every machine.

use std::sync::LazyLock;

use ab_glyph::{Font, FontRef, Glyph, OutlinedGlyph, PxScale, PxScaleFont, ScaleFont, point};
use image::RgbaImage;

use super::colour::{Colour, blend_pixel};

static REGULAR: LazyLock<FontRef> =
    LazyLock::new(|| embedded(include_bytes!("../../assets/fonts/DejaVuSansCondensed.ttf")));
static BOLD: LazyLock<FontRef> =
    LazyLock::new(|| embedded(include_bytes!("../../assets/fonts/DejaVuSansCondensed-Bold.ttf")));

fn embedded(bytes: &'static [u8]) -> FontRef<'static> {
    // The font is part of the program, and a test draws text with it, so loading cannot fail.
    FontRef::try_from_slice(bytes).expect("an embedded font is a font")
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TextStyle {
    pub size_px: f32,
    pub is_bold: bool,
    pub colour: Colour,
    /// Alignment of the lines of a text block relative to each other.
    pub lines: Align,
}

impl TextStyle {
    /// Returns the style of regular text with left-aligned lines.
    pub(crate) fn new(size_px: f32, colour: Colour) -> Self {
        Self { size_px, is_bold: false, colour, lines: Align::Start }
    }

    pub(crate) fn bold(self) -> Self {
        Self { is_bold: true, ..self }
    }

    pub(crate) fn centred(self) -> Self {
        Self { lines: Align::Centre, ..self }
    }

    fn font(&self) -> PxScaleFont<&FontRef<'static>> {
        let font: &FontRef = if self.is_bold { &BOLD } else { &REGULAR };
        // The library ab_glyph scales the height from descent to ascent, whereas a font size is the size of the em.
        let per_em = font.units_per_em().map_or(1.0, |units| font.height_unscaled() / units);
        font.as_scaled(PxScale::from(self.size_px * per_em))
    }

    /// Places the letters of one line, from x = 0 on the baseline y = 0, with y pointing down. Returns the letters and
    /// the width of the line, pixels. `_{…}` makes a subscript, `^{…}` a superscript.
    pub(super) fn set(&self, line: &str) -> (Vec<Glyph>, f32) {
        let mut glyphs = Vec::new();
        let mut pen = 0.0;
        for (text, level) in runs(line) {
            let style = Self { size_px: self.size_px * level.size(), ..*self };
            let font = style.font();
            let mut before = None;
            for letter in text.chars() {
                let mut glyph = font.scaled_glyph(letter);
                let id = glyph.id;
                pen += before.map_or(0.0, |before| font.kern(before, id));
                glyph.position = point(pen, level.drop() * self.size_px);
                glyphs.push(glyph);
                pen += font.h_advance(id);
                before = Some(id);
            }
        }
        (glyphs, pen)
    }

    /// Returns the outline of a letter that [`Self::set`] placed, moved by (`x`, `y`), pixels; `None` for a space.
    pub(super) fn shape(&self, mut glyph: Glyph, x: f32, y: f32) -> Option<OutlinedGlyph> {
        glyph.position += point(x, y);
        self.font().outline_glyph(glyph)
    }

    pub(crate) fn width(&self, line: &str) -> f32 {
        self.set(line).1
    }

    /// Distance from the top of a line to its baseline, pixels.
    pub(super) fn ascent(&self) -> f32 {
        self.font().ascent()
    }

    /// Distance between the baselines of two lines, pixels.
    pub(crate) fn line_height(&self) -> f32 {
        self.font().height()
    }

    /// True if the font has a shape for this letter.
    #[cfg(test)]
    fn has(&self, letter: char) -> bool {
        // Glyph 0 is the box that fonts show for missing letters.
        self.font().glyph_id(letter).0 != 0
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Script {
    Line,
    Below,
    Above,
}

impl Script {
    /// Font size of normal letters, subscripts or superscripts (`self`), divided by the font size of the line.
    fn size(self) -> f32 {
        if self == Self::Line { 1.0 } else { 0.7 }
    }

    /// Distance of normal letters, subscripts or superscripts (`self`) below the baseline of the line, in font sizes of
    /// the line; negative for superscripts, which are above it.
    fn drop(self) -> f32 {
        match self {
            Self::Line => 0.0,
            Self::Below => 0.2,
            Self::Above => -0.36,
        }
    }
}

/// Splits a line into pieces of normal text, subscripts (`_{…}`) and superscripts (`^{…}`). A brace without its partner
/// is normal text.
fn runs(line: &str) -> Vec<(&str, Script)> {
    let mut found = Vec::new();
    let mut rest = line;
    while let Some(start) = rest.find("_{").into_iter().chain(rest.find("^{")).min() {
        let Some(length) = rest[start + 2..].find('}') else { break };
        let level = if rest[start..].starts_with('_') { Script::Below } else { Script::Above };
        found.push((&rest[..start], Script::Line));
        found.push((&rest[start + 2..start + 2 + length], level));
        rest = &rest[start + 3 + length..];
    }
    found.push((rest, Script::Line));
    found
}

/// Alignment of a text block in one direction, relative to the point at which it is drawn. The same type describes the
/// alignment of the lines of a block relative to each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Align {
    /// The block is drawn with its left or top edge at the point.
    #[default]
    Start,
    /// The block is drawn with its middle at the point.
    Centre,
    /// The block is drawn with its right or bottom edge at the point.
    End,
}

impl Align {
    /// Returns the distance from the left or top edge of a block to the point at which the block is drawn, pixels.
    /// `length` is the width or height of the block, pixels.
    pub(super) fn share(self, length: u32) -> u32 {
        match self {
            Self::Start => 0,
            Self::Centre => length / 2,
            Self::End => length,
        }
    }
}

/// Text that is laid out: a mask (the fraction of each pixel that letters cover) and a colour.
#[derive(Clone, Debug)]
pub(crate) struct TextBlock {
    width: u32,
    height: u32,
    /// Fraction of each pixel that the text covers, 0 to 1, row by row.
    coverage: Vec<f32>,
    colour: Colour,
}

impl TextBlock {
    /// Lays text out as a block. `\n` ends a line, `_{…}` makes a subscript and `^{…}` a superscript.
    pub(crate) fn new(text: &str, style: &TextStyle) -> Self {
        let lines: Vec<&str> = text.split('\n').collect();
        let widest = lines.iter().map(|line| style.width(line)).fold(0.0, f32::max);
        // Slanted and accented letters may extend a pixel beyond their advance width.
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

    /// Lays text out as a block and breaks lines at spaces, so that no line is wider than `largest_width_px`. If a
    /// single word is wider, the font size of the whole block is reduced.
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

    pub(crate) fn width(&self) -> u32 {
        self.width
    }

    pub(crate) fn height(&self) -> u32 {
        self.height
    }

    /// Fraction of the block's area that letters cover, 0 to 1.
    #[cfg(test)]
    pub(crate) fn ink(&self) -> f32 {
        self.coverage.iter().sum::<f32>() / self.coverage.len().max(1) as f32
    }

    /// Returns the text block turned by 90° anticlockwise, so that it reads upwards, like the label of a vertical axis.
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

    /// Draws the text block at the point (`x`, `y`), in pixels from the upper left corner of the image. `across` and
    /// `down` are the horizontal and vertical alignment of the block at this point. Parts outside the image are left
    /// out.
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

    const NEEDED: &str =
        "ABCXYZabcxyz0123456789 ΔδρμωΣΩτφθεπ·−–×√≤≥±≈°∞→%‖⁰¹²³⁴⁵⁶⁷⁸⁹⁻₀₁₂₃…’“”()[]/|";

    #[test]
    fn every_needed_letter_has_a_shape_in_both_weights() {
        let regular = TextStyle::new(20.0, Colour::BLACK);
        for style in [regular, regular.bold()] {
            for letter in NEEDED.chars() {
                assert!(style.has(letter), "no {letter}, bold: {}", style.is_bold);
                let inked = TextBlock::new(&letter.to_string(), &style).ink() > 0.0;
                assert_eq!(inked, letter != ' ', "{letter}");
            }
        }
        assert!(!regular.has('漢'), "a letter that is missing must be seen as missing");
    }

    #[test]
    fn the_size_is_the_em() {
        // An em dash of this condensed font is exactly 0.9 em wide.
        let width = TextStyle::new(100.0, Colour::BLACK).width("—");
        assert!((width - 90.0).abs() < 1.0, "{width}");
    }

    #[test]
    fn braces_raise_and_lower() {
        assert_eq!(
            runs("Δy_{G} = 10^{−3} s"),
            [
                ("Δy", Script::Line),
                ("G", Script::Below),
                (" = 10", Script::Line),
                ("−3", Script::Above),
                (" s", Script::Line)
            ]
        );
        assert_eq!(runs("a_b^c {d} _{e"), [("a_b^c {d} _{e", Script::Line)]);
        let style = TextStyle::new(20.0, Colour::BLACK);
        assert!(style.width("y_{G}") < style.width("yG"));
    }

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
