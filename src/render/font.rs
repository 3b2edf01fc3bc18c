//! The font of all words, and how wide they are.
//!
//! DejaVu Sans Condensed is free, and has the Greek letters, superscripts and signs that physics
//! needs. It is part of the program, so that words look the same on every machine.

use std::sync::LazyLock;

use ab_glyph::{Font, FontRef, PxScale, ScaleFont};

use super::Colour;
use super::text::Align;

static REGULAR: LazyLock<FontRef> =
    LazyLock::new(|| embedded(include_bytes!("../../assets/fonts/DejaVuSansCondensed.ttf")));
static BOLD: LazyLock<FontRef> =
    LazyLock::new(|| embedded(include_bytes!("../../assets/fonts/DejaVuSansCondensed-Bold.ttf")));

fn embedded(bytes: &'static [u8]) -> FontRef<'static> {
    // The file is part of the program and a test sets text in it.
    FontRef::try_from_slice(bytes).expect("an embedded font is a font")
}

/// Thickness of the strokes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Weight {
    /// Text.
    #[default]
    Regular,
    /// Titles.
    Bold,
}

/// How text looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextStyle {
    /// Font size (em), pixels.
    pub size_px: f32,
    /// Thickness.
    pub weight: Weight,
    /// Colour.
    pub colour: Colour,
    /// How lines lie relative to each other.
    pub lines: Align,
}

impl TextStyle {
    /// Regular text of a size, lines flush left.
    pub fn new(size_px: f32, colour: Colour) -> Self {
        Self { size_px, weight: Weight::Regular, colour, lines: Align::Start }
    }

    /// The same in bold.
    pub fn bold(self) -> Self {
        Self { weight: Weight::Bold, ..self }
    }

    /// The same with centred lines.
    pub fn centred(self) -> Self {
        Self { lines: Align::Centre, ..self }
    }

    pub(super) fn font(&self) -> ab_glyph::PxScaleFont<&FontRef<'static>> {
        let font: &FontRef = match self.weight {
            Weight::Regular => &REGULAR,
            Weight::Bold => &BOLD,
        };
        // ab_glyph scales the height from descent to ascent, not the em.
        let per_em = font.units_per_em().map_or(1.0, |units| font.height_unscaled() / units);
        font.as_scaled(PxScale::from(self.size_px * per_em))
    }

    /// Width of one line, pixels.
    pub fn width(&self, line: &str) -> f32 {
        let font = self.font();
        let mut width = 0.0;
        let mut before = None;
        for glyph in line.chars().map(|letter| font.glyph_id(letter)) {
            width += before.map_or(0.0, |before| font.kern(before, glyph)) + font.h_advance(glyph);
            before = Some(glyph);
        }
        width
    }

    /// Distance from line to line, pixels.
    pub fn line_height(&self) -> f32 {
        self.font().height()
    }

    /// Whether the font has a shape for this letter.
    pub fn has(&self, letter: char) -> bool {
        // Glyph 0 is the box that stands for missing letters.
        self.font().glyph_id(letter).0 != 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::TextBlock;

    const NEEDED: &str =
        "ABCXYZabcxyz0123456789 ΔδρμωΣΩτφθεπ·−–×√≤≥±≈°∞→%‖⁰¹²³⁴⁵⁶⁷⁸⁹⁻₀₁₂₃…’“”()[]/|";

    #[test]
    fn every_needed_letter_has_a_shape_in_both_weights() {
        let regular = TextStyle::new(20.0, Colour::BLACK);
        for style in [regular, regular.bold()] {
            for letter in NEEDED.chars() {
                assert!(style.has(letter), "no {letter} in {:?}", style.weight);
                let inked = TextBlock::new(&letter.to_string(), &style).ink() > 0.0;
                assert_eq!(inked, letter != ' ', "{letter}");
            }
        }
        assert!(!regular.has('漢'), "a letter that is missing must be seen as missing");
    }

    #[test]
    fn the_size_is_the_em() {
        // An em dash of this font is exactly 0.9 em wide, as its condensed cut makes it.
        let width = TextStyle::new(100.0, Colour::BLACK).width("—");
        assert!((width - 90.0).abs() < 1.0, "{width}");
    }
}
