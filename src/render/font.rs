//! The font of all words, and how wide they are.
//!
//! DejaVu Sans Condensed is free, and has the Greek letters, superscripts and signs that physics
//! needs. It is part of the program, so that words look the same on every machine.

use std::sync::LazyLock;

use ab_glyph::{Font, FontRef, Glyph, OutlinedGlyph, PxScale, PxScaleFont, ScaleFont, point};

use super::Colour;
use super::align::Align;

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
pub(crate) enum Weight {
    /// Text.
    #[default]
    Regular,
    /// Titles.
    Bold,
}

/// How text looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TextStyle {
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
    pub(crate) fn new(size_px: f32, colour: Colour) -> Self {
        Self { size_px, weight: Weight::Regular, colour, lines: Align::Start }
    }

    /// The same in bold.
    pub(crate) fn bold(self) -> Self {
        Self { weight: Weight::Bold, ..self }
    }

    /// The same with centred lines.
    pub(crate) fn centred(self) -> Self {
        Self { lines: Align::Centre, ..self }
    }

    fn font(&self) -> PxScaleFont<&FontRef<'static>> {
        let font: &FontRef = match self.weight {
            Weight::Regular => &REGULAR,
            Weight::Bold => &BOLD,
        };
        // ab_glyph scales the height from descent to ascent, not the em.
        let per_em = font.units_per_em().map_or(1.0, |units| font.height_unscaled() / units);
        font.as_scaled(PxScale::from(self.size_px * per_em))
    }

    /// Places the letters of one line, from x = 0 on the baseline y = 0, y down; gives them and
    /// the width. `_{…}` sets letters below the baseline, `^{…}` above it.
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

    /// The shape of a letter that [`Self::set`] placed, moved; none for a space.
    pub(super) fn shape(&self, mut glyph: Glyph, x: f32, y: f32) -> Option<OutlinedGlyph> {
        glyph.position += point(x, y);
        self.font().outline_glyph(glyph)
    }

    /// Width of one line, pixels.
    pub(crate) fn width(&self, line: &str) -> f32 {
        self.set(line).1
    }

    /// From the top of a line to its baseline, pixels.
    pub(super) fn ascent(&self) -> f32 {
        self.font().ascent()
    }

    /// Distance from line to line, pixels.
    pub(crate) fn line_height(&self) -> f32 {
        self.font().height()
    }

    /// Whether the font has a shape for this letter.
    #[cfg(test)]
    fn has(&self, letter: char) -> bool {
        // Glyph 0 is the box that stands for missing letters.
        self.font().glyph_id(letter).0 != 0
    }
}

/// How letters stand on the line.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Level {
    Line,
    Below,
    Above,
}

impl Level {
    /// Size of the letters relative to those on the line.
    fn size(self) -> f32 {
        if self == Self::Line { 1.0 } else { 0.7 }
    }

    /// How far they stand below the baseline, in units of the line's font size.
    fn drop(self) -> f32 {
        match self {
            Self::Line => 0.0,
            Self::Below => 0.2,
            Self::Above => -0.36,
        }
    }
}

/// Cuts a line into runs of one level. A brace that never closes is text.
fn runs(line: &str) -> Vec<(&str, Level)> {
    let mut found = Vec::new();
    let mut rest = line;
    while let Some(start) = rest.find("_{").into_iter().chain(rest.find("^{")).min() {
        let Some(length) = rest[start + 2..].find('}') else { break };
        let level = if rest[start..].starts_with('_') { Level::Below } else { Level::Above };
        found.push((&rest[..start], Level::Line));
        found.push((&rest[start + 2..start + 2 + length], level));
        rest = &rest[start + 3 + length..];
    }
    found.push((rest, Level::Line));
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::text::TextBlock;

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

    #[test]
    fn braces_raise_and_lower() {
        assert_eq!(
            runs("Δy_{G} = 10^{−3} s"),
            [
                ("Δy", Level::Line),
                ("G", Level::Below),
                (" = 10", Level::Line),
                ("−3", Level::Above),
                (" s", Level::Line)
            ]
        );
        assert_eq!(runs("a_b^c {d} _{e"), [("a_b^c {d} _{e", Level::Line)]);
        let style = TextStyle::new(20.0, Colour::BLACK);
        assert!(style.width("y_{G}") < style.width("yG"));
    }
}
