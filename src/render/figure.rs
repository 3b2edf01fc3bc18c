//! A figure of several pictures, arranged as in a journal: a grid of panels with labels.
//!
//! The sizes of all labels are computed first, and the grid reserves the space that they need. So no label is cut off
//! or covers another label. A long label is broken at its spaces, and a label with a word that is too long gets a
//! smaller font.

use image::{RgbaImage, imageops};

use super::legend::fill;
use super::text::{Align, TextBlock, TextStyle};
use super::{Palette, Theme};

/// A grid of panels (pictures of one size), filled row by row.
#[derive(Clone, Debug, Default)]
pub struct PanelGrid {
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
    /// The pictures, all of one size; at most `rows` × `columns`.
    pub panels: Vec<RgbaImage>,
    /// Titles in the upper left corners of the panels, one per panel; empty for panels without titles.
    pub panel_titles: Vec<String>,
    /// Labels to the left of the rows, one per row; the text runs upwards.
    pub row_labels: Vec<String>,
    /// Labels above the columns, one per column.
    pub column_labels: Vec<String>,
    /// Title above the grid, in bold type.
    pub title: String,
    /// Caption below the grid.
    pub caption: String,
}

impl PanelGrid {
    /// Returns a grid of panels without labels, on a white background.
    pub fn new(rows: usize, columns: usize, panels: Vec<RgbaImage>) -> Self {
        Self { rows, columns, panels, ..Self::default() }
    }

    /// Draws the figure. Its size depends on the panels and the labels.
    pub fn draw(&self) -> RgbaImage {
        let palette = Theme::Light.palette();
        let (rows, columns) = (self.rows as u32, self.columns as u32);
        let [across, down] = self.panels.first().map_or([0, 0], |panel| panel.dimensions().into());
        // The font size is 18 px if the panels are together 1600 px wide, and at least 14 px, so that labels on small
        // grids are readable.
        let text_px = ((across * columns) as f32 / 88.0).clamp(14.0, 48.0).round();
        let gap = (0.6 * text_px).round() as u32;
        let text = TextStyle::new(text_px, palette.ink);
        let heading = TextStyle { size_px: 1.15 * text_px, ..text }.bold();

        let row_labels = blocks(&self.row_labels, text.centred(), down);
        let row_labels: Vec<_> = row_labels.iter().map(TextBlock::turned).collect();
        let column_labels = blocks(&self.column_labels, text.centred(), across);
        let with_gap = |length: Option<u32>| length.map_or(0, |length| length + gap / 2);
        let label_width = with_gap(row_labels.iter().map(TextBlock::width).max());
        let label_height = with_gap(column_labels.iter().map(TextBlock::height).max());
        let grid_width = label_width + columns * across + (columns - 1) * gap;
        let line = |label: &str, style: TextStyle| {
            (!label.is_empty()).then(|| TextBlock::wrapped(label, &style, grid_width as f32))
        };
        let (title, caption) = (line(&self.title, heading), line(&self.caption, text));
        let line_height =
            |line: &Option<TextBlock>| line.as_ref().map_or(0, |line| line.height() + gap);

        let (left, top) = (gap + label_width, gap + line_height(&title) + label_height);
        let height = top + rows * down + (rows - 1) * gap + line_height(&caption) + gap;
        let ground = palette.ground.to_rgba8();
        let mut image = RgbaImage::from_pixel(grid_width + 2 * gap, height, ground);
        let [left, top, across, down, gap, height] =
            [left, top, across, down, gap, height].map(i64::from);
        if let Some(title) = title {
            title.draw(&mut image, gap, gap, Align::Start, Align::Start);
        }
        if let Some(caption) = caption {
            caption.draw(&mut image, gap, height - gap, Align::Start, Align::End);
        }
        let x = |column: usize| left + column as i64 * (across + gap);
        let y = |row: usize| top + row as i64 * (down + gap);
        for (column, label) in column_labels.iter().enumerate() {
            let middle = x(column) + across / 2;
            label.draw(&mut image, middle, top - gap / 2, Align::Centre, Align::End);
        }
        for (row, label) in row_labels.iter().enumerate() {
            let middle = y(row) + down / 2;
            label.draw(&mut image, left - gap / 2, middle, Align::End, Align::Centre);
        }
        // A title in the corner of a panel needs a margin on its left and its right.
        let titles = blocks(&self.panel_titles, text, (across - 2 * gap).max(0) as u32);
        for (index, panel) in self.panels.iter().enumerate() {
            let corner = [x(index % self.columns), y(index / self.columns)];
            draw_panel(&mut image, panel, corner, &palette);
            if let Some(title) = titles.get(index) {
                let [left, top] = corner.map(|side| side + gap / 2);
                let [width, height] = [title.width(), title.height()].map(i64::from);
                fill(&mut image, left, left + width + gap / 2, top, top + height, palette.ground);
                title.draw(&mut image, left + gap / 4, top, Align::Start, Align::Start);
            }
        }
        image
    }
}

/// Lays labels out as blocks of text that are at most `width` pixels wide.
fn blocks(labels: &[String], style: TextStyle, width: u32) -> Vec<TextBlock> {
    labels.iter().map(|label| TextBlock::wrapped(label, &style, width as f32)).collect()
}

/// Draws a panel with a frame, its upper left corner at `corner`.
fn draw_panel(image: &mut RgbaImage, panel: &RgbaImage, [x, y]: [i64; 2], palette: &Palette) {
    imageops::replace(image, panel, x, y);
    let (right, bottom) = (x + i64::from(panel.width()), y + i64::from(panel.height()));
    let colour = palette.ground.mix(palette.ink, 0.45);
    fill(image, x, right, y, y + 1, colour);
    fill(image, x, right, bottom - 1, bottom, colour);
    fill(image, x, x + 1, y, bottom, colour);
    fill(image, right - 1, right, y, bottom, colour);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::Colour;

    #[test]
    fn panels_stay_whole_beside_long_labels() {
        let teal = Colour::hex(0x2c728e).to_rgba8();
        let mut figure = PanelGrid::new(2, 2, vec![RgbaImage::from_pixel(120, 80, teal); 4]);
        let long = "a label that is far too long for its place in the grid".to_owned();
        figure.row_labels = vec![long.clone(), long.clone()];
        figure.column_labels = vec![long.clone(), "short".into()];
        figure.title = long.clone();
        figure.caption = long;
        let image = figure.draw();
        let covered = image.pixels().filter(|pixel| **pixel == teal).count();
        assert_eq!(covered, 4 * 118 * 78, "no label may cover a panel within its frame");
        // The outermost pixels are white, so no label is cut off.
        let (width, height) = image.dimensions();
        let white = Colour::WHITE.to_rgba8();
        assert!((0..width).all(|x| *image.get_pixel(x, 0) == white));
        assert!((0..width).all(|x| *image.get_pixel(x, height - 1) == white));
        assert!((0..height).all(|y| *image.get_pixel(0, y) == white));
        assert!((0..height).all(|y| *image.get_pixel(width - 1, y) == white));
    }
}
