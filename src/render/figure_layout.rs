//! Where the panels and labels of a figure lie: every label is laid out first, then the grid takes
//! the room that they need.

use image::{RgbaImage, imageops};

use super::Palette;
use super::align::Align;
use super::figure::Figure;
use super::font::TextStyle;
use super::legend::fill;
use super::text::TextBlock;
use crate::error::Result;

impl Figure {
    /// Draws the figure. Its size follows from the panels and the labels.
    ///
    /// # Errors
    /// Names the list that does not fit the grid, or the panel of another size.
    pub fn draw(&self) -> Result<RgbaImage> {
        let panel = self.validate()?;
        let palette = self.theme.palette();
        let layout = Layout::new(self, panel, &palette);
        let (width, height) = layout.size(self);
        let mut image = RgbaImage::from_pixel(width, height, palette.ground.to_rgba8());
        layout.draw(self, &palette, &mut image);
        Ok(image)
    }
}

/// The blocks of a figure, laid out, and the room they take. Lengths in pixels.
pub(super) struct Layout {
    gap: u32,
    panel: (u32, u32),
    title: Option<TextBlock>,
    caption: Option<TextBlock>,
    columns: Vec<Option<TextBlock>>,
    rows: Vec<Option<TextBlock>>,
    panels: Vec<Option<TextBlock>>,
    /// Width of the row labels with their gap.
    row_label_width: u32,
    column_label_height: u32,
    /// Height of the titles above the panels of each row, with their gap.
    title_heights: Vec<u32>,
}

impl Layout {
    pub(super) fn new(figure: &Figure, panel: (u32, u32), palette: &Palette) -> Self {
        let columns = figure.columns as u32;
        let text_px = figure.text_size(panel.0 * columns);
        let gap = (0.6 * text_px).round() as u32;
        let text = TextStyle::new(text_px, palette.ink);
        let block = |label: Option<&String>, style: TextStyle, width: u32| {
            let label = label.filter(|label| !label.trim().is_empty())?;
            Some(TextBlock::wrapped(label, &style, width as f32))
        };
        let rows: Vec<_> = (0..figure.rows)
            .map(|row| block(figure.row_labels.get(row), text.centred(), panel.1))
            .map(|label| label.map(|label| label.turned()))
            .collect();
        let column_blocks: Vec<_> = (0..figure.columns)
            .map(|column| block(figure.column_labels.get(column), text.centred(), panel.0))
            .collect();
        // A title in a corner needs a margin on both of its sides.
        let title_width =
            if figure.titles_inside { panel.0.saturating_sub(2 * gap) } else { panel.0 };
        let panels: Vec<_> = (0..figure.rows * figure.columns)
            .map(|index| block(figure.panel_titles.get(index), text, title_width))
            .collect();
        let with_gap = |length: Option<u32>| length.map_or(0, |length| length + gap / 2);
        let tallest =
            |blocks: &[Option<TextBlock>]| blocks.iter().flatten().map(TextBlock::height).max();
        let row_label_width = with_gap(rows.iter().flatten().map(TextBlock::width).max());
        let title_heights = panels
            .chunks(figure.columns)
            .map(|row| if figure.titles_inside { 0 } else { with_gap(tallest(row)) })
            .collect();
        let grid_width = row_label_width + columns * panel.0 + (columns - 1) * gap;
        let heading = TextStyle { size_px: 1.15 * text_px, ..text }.bold();
        Self {
            gap,
            panel,
            title: block(Some(&figure.title), heading, grid_width),
            caption: block(Some(&figure.caption), text, grid_width),
            column_label_height: with_gap(tallest(&column_blocks)),
            columns: column_blocks,
            rows,
            panels,
            row_label_width,
            title_heights,
        }
    }

    /// Height of the title, or of the caption, with its gap.
    fn outer(&self, block: &Option<TextBlock>) -> u32 {
        block.as_ref().map_or(0, |block| block.height() + self.gap)
    }

    pub(super) fn size(&self, figure: &Figure) -> (u32, u32) {
        let (rows, columns) = (figure.rows as u32, figure.columns as u32);
        let width =
            2 * self.gap + self.row_label_width + columns * self.panel.0 + (columns - 1) * self.gap;
        let height = 2 * self.gap
            + self.outer(&self.title)
            + self.column_label_height
            + self.title_heights.iter().sum::<u32>()
            + rows * self.panel.1
            + (rows - 1) * self.gap
            + self.outer(&self.caption);
        (width, height)
    }

    pub(super) fn draw(&self, figure: &Figure, palette: &Palette, image: &mut RgbaImage) {
        let (width, height) = (i64::from(image.width()), i64::from(image.height()));
        let gap = i64::from(self.gap);
        let panel = (i64::from(self.panel.0), i64::from(self.panel.1));
        let left = gap + i64::from(self.row_label_width);
        let mut top = gap + i64::from(self.outer(&self.title));
        if let Some(title) = &self.title {
            title.draw(image, gap, gap, Align::Start, Align::Start);
        }
        if let Some(caption) = &self.caption {
            caption.draw(image, gap, height - gap, Align::Start, Align::End);
        }
        let column_left = |column: usize| left + column as i64 * (panel.0 + gap);
        top += i64::from(self.column_label_height);
        for (column, label) in self.columns.iter().enumerate() {
            if let Some(label) = label {
                let x = column_left(column) + panel.0 / 2;
                label.draw(image, x, top - gap / 2, Align::Centre, Align::End);
            }
        }
        for (row, label) in self.rows.iter().enumerate() {
            top += i64::from(self.title_heights[row]);
            if let Some(label) = label {
                label.draw(image, left - gap / 2, top + panel.1 / 2, Align::End, Align::Centre);
            }
            for column in 0..figure.columns {
                let index = row * figure.columns + column;
                self.draw_panel(figure, palette, image, index, (column_left(column), top));
            }
            top += panel.1 + gap;
        }
        debug_assert!(column_left(figure.columns) <= width && top <= height);
    }

    fn draw_panel(
        &self,
        figure: &Figure,
        palette: &Palette,
        image: &mut RgbaImage,
        index: usize,
        (x, y): (i64, i64),
    ) {
        let Some(panel) = figure.panels.get(index) else { return };
        imageops::replace(image, panel, x, y);
        let (right, bottom) = (x + i64::from(self.panel.0), y + i64::from(self.panel.1));
        if figure.frames {
            let colour = palette.ground.mix(palette.ink, 0.45);
            fill(image, x, right, y, y + 1, colour);
            fill(image, x, right, bottom - 1, bottom, colour);
            fill(image, x, x + 1, y, bottom, colour);
            fill(image, right - 1, right, y, bottom, colour);
        }
        let Some(Some(title)) = self.panels.get(index) else { return };
        let gap = i64::from(self.gap);
        if figure.titles_inside {
            let (left, top) = (x + gap / 2, y + gap / 2);
            let (width, height) = (i64::from(title.width()), i64::from(title.height()));
            fill(image, left, left + width + gap / 2, top, top + height, palette.ground);
            title.draw(image, left + gap / 4, top, Align::Start, Align::Start);
        } else {
            title.draw(image, x, y - gap / 2 + gap / 4, Align::Start, Align::End);
        }
    }
}
