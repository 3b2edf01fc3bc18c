//! A figure of several pictures, arranged as in a journal: a grid of panels with labels.
//!
//! The sizes of all labels are computed first, and the grid reserves the space that they need. So no label is cut off
//! or covers another label. A long label is broken at its spaces, and a label with a word that is too long gets a
//! smaller font.

use image::{RgbaImage, imageops};

use super::legend::fill;
use super::text::{Align, TextBlock, TextStyle};
use super::{Palette, Theme};
use crate::error::{Error, Result};

/// A grid of panels (pictures of one size), filled row by row.
#[derive(Clone, Debug)]
pub struct PanelGrid {
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
    /// The pictures, all of one size; at most `rows` × `columns`.
    pub panels: Vec<RgbaImage>,
    /// Title of each panel. A panel has no title if the title is empty or the list is too short.
    pub panel_titles: Vec<String>,
    /// True if the title of each panel is in its upper left corner; false if it is above the panel.
    pub titles_inside: bool,
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
        Self {
            rows,
            columns,
            panels,
            panel_titles: Vec::new(),
            titles_inside: false,
            row_labels: Vec::new(),
            column_labels: Vec::new(),
            title: String::new(),
            caption: String::new(),
        }
    }

    /// Draws the figure. Its size depends on the panels and the labels.
    ///
    /// # Errors
    /// Names a list of labels or panels that is too long for the grid, or a panel whose size differs from the first
    /// panel.
    pub fn draw(&self) -> Result<RgbaImage> {
        let panel = self.validate()?;
        let palette = Theme::Light.palette();
        let layout = GridLayout::new(self, panel, &palette);
        let [width, height] = layout.size(self);
        let mut image = RgbaImage::from_pixel(width, height, palette.ground.to_rgba8());
        layout.draw(self, &palette, &mut image);
        Ok(image)
    }

    /// Checks that the lists of panels and labels fit the grid. Returns width and height of a panel, pixels.
    fn validate(&self) -> Result<[u32; 2]> {
        let places = self.rows * self.columns;
        let Some(first) = self.panels.first() else {
            return Err(Error::value("panels", "empty", "at least one picture"));
        };
        for (name, found, most) in [
            ("panels", self.panels.len(), places),
            ("panel_titles", self.panel_titles.len(), places),
            ("row_labels", self.row_labels.len(), self.rows),
            ("column_labels", self.column_labels.len(), self.columns),
        ] {
            if found > most {
                let allowed = format!("at most {most} on a {}x{} grid", self.rows, self.columns);
                return Err(Error::value(name, format!("a list of {found}"), allowed));
            }
        }
        let [width, height]: [u32; 2] = first.dimensions().into();
        let differs = |panel: &&RgbaImage| panel.dimensions() != (width, height);
        if let Some(other) = self.panels.iter().find(differs) {
            let found = format!("{}x{}", other.width(), other.height());
            return Err(Error::value("panels", found, format!("{width}x{height} like the first")));
        }
        Ok([width, height])
    }
}

/// The text blocks of a figure and the space that they need. Lengths are in pixels.
struct GridLayout {
    gap: u32,
    panel: [u32; 2],
    title: Option<TextBlock>,
    caption: Option<TextBlock>,
    columns: Vec<Option<TextBlock>>,
    rows: Vec<Option<TextBlock>>,
    panels: Vec<Option<TextBlock>>,
    /// Width of the widest row label plus the gap to the panels, pixels.
    row_label_width: u32,
    column_label_height: u32,
    /// For each row, the height of the titles above its panels plus the gap below the titles, pixels.
    title_heights: Vec<u32>,
}

impl GridLayout {
    fn new(figure: &PanelGrid, panel: [u32; 2], palette: &Palette) -> Self {
        let columns = figure.columns as u32;
        // The font size is 18 px if the panels are together 1600 px wide, and at least 14 px, so that labels on small
        // grids are readable.
        let text_px = ((panel[0] * columns) as f32 / 88.0).clamp(14.0, 48.0).round();
        let gap = (0.6 * text_px).round() as u32;
        let text = TextStyle::new(text_px, palette.ink);
        let block = |label: Option<&String>, style: TextStyle, width: u32| {
            let label = label.filter(|label| !label.trim().is_empty())?;
            Some(TextBlock::wrapped(label, &style, width as f32))
        };
        let rows: Vec<_> = (0..figure.rows)
            .map(|row| block(figure.row_labels.get(row), text.centred(), panel[1]))
            .map(|label| label.map(|label| label.turned()))
            .collect();
        let column_blocks: Vec<_> = (0..figure.columns)
            .map(|column| block(figure.column_labels.get(column), text.centred(), panel[0]))
            .collect();
        // A title in the corner of a panel needs a margin on its left and its right.
        let title_width =
            if figure.titles_inside { panel[0].saturating_sub(2 * gap) } else { panel[0] };
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
        let grid_width = row_label_width + columns * panel[0] + (columns - 1) * gap;
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

    /// Height of the title or the caption plus its gap to the grid, pixels.
    fn outer(&self, block: &Option<TextBlock>) -> u32 {
        block.as_ref().map_or(0, |block| block.height() + self.gap)
    }

    fn size(&self, figure: &PanelGrid) -> [u32; 2] {
        let (rows, columns) = (figure.rows as u32, figure.columns as u32);
        let width = 2 * self.gap
            + self.row_label_width
            + columns * self.panel[0]
            + (columns - 1) * self.gap;
        let height = 2 * self.gap
            + self.outer(&self.title)
            + self.column_label_height
            + self.title_heights.iter().sum::<u32>()
            + rows * self.panel[1]
            + (rows - 1) * self.gap
            + self.outer(&self.caption);
        [width, height]
    }

    fn draw(&self, figure: &PanelGrid, palette: &Palette, image: &mut RgbaImage) {
        let (width, height) = (i64::from(image.width()), i64::from(image.height()));
        let gap = i64::from(self.gap);
        let panel = self.panel.map(i64::from);
        let left = gap + i64::from(self.row_label_width);
        let mut top = gap + i64::from(self.outer(&self.title));
        if let Some(title) = &self.title {
            title.draw(image, gap, gap, Align::Start, Align::Start);
        }
        if let Some(caption) = &self.caption {
            caption.draw(image, gap, height - gap, Align::Start, Align::End);
        }
        let column_left = |column: usize| left + column as i64 * (panel[0] + gap);
        top += i64::from(self.column_label_height);
        for (column, label) in self.columns.iter().enumerate() {
            if let Some(label) = label {
                let x = column_left(column) + panel[0] / 2;
                label.draw(image, x, top - gap / 2, Align::Centre, Align::End);
            }
        }
        for (row, label) in self.rows.iter().enumerate() {
            top += i64::from(self.title_heights[row]);
            if let Some(label) = label {
                label.draw(image, left - gap / 2, top + panel[1] / 2, Align::End, Align::Centre);
            }
            for column in 0..figure.columns {
                let index = row * figure.columns + column;
                self.draw_panel(figure, palette, image, index, column_left(column), top);
            }
            top += panel[1] + gap;
        }
        debug_assert!(column_left(figure.columns) <= width && top <= height);
    }

    fn draw_panel(
        &self,
        figure: &PanelGrid,
        palette: &Palette,
        image: &mut RgbaImage,
        index: usize,
        x: i64,
        y: i64,
    ) {
        let Some(panel) = figure.panels.get(index) else { return };
        imageops::replace(image, panel, x, y);
        let (right, bottom) = (x + i64::from(self.panel[0]), y + i64::from(self.panel[1]));
        let colour = palette.ground.mix(palette.ink, 0.45);
        fill(image, x, right, y, y + 1, colour);
        fill(image, x, right, bottom - 1, bottom, colour);
        fill(image, x, x + 1, y, bottom, colour);
        fill(image, right - 1, right, y, bottom, colour);
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

#[cfg(test)]
mod tests {

    use super::*;
    use crate::render::Colour;

    fn panels(count: usize) -> Vec<RgbaImage> {
        vec![RgbaImage::from_pixel(120, 80, Colour::hex(0x2c728e).to_rgba8()); count]
    }

    #[test]
    fn lists_that_do_not_fit_are_named() {
        let mut figure = PanelGrid::new(1, 2, panels(3));
        assert!(figure.draw().unwrap_err().to_string().starts_with("panels is a list of 3"));
        figure.panels = vec![RgbaImage::new(10, 10), RgbaImage::new(11, 10)];
        assert!(figure.draw().unwrap_err().to_string().starts_with("panels is 11x10"));
        figure.panels = Vec::new();
        assert!(figure.draw().unwrap_err().to_string().starts_with("panels is empty"));
        figure.panels = panels(2);
        figure.row_labels = vec!["a".into(), "b".into()];
        assert!(figure.draw().unwrap_err().to_string().starts_with("row_labels is a list of 2"));
    }

    #[test]
    fn panels_stay_whole_beside_long_labels() {
        let mut figure = PanelGrid::new(2, 2, panels(4));
        let long = "a label that is far too long for its place in the grid".to_owned();
        figure.row_labels = vec![long.clone(), long.clone()];
        figure.column_labels = vec![long.clone(), "short".into()];
        figure.panel_titles = vec![long.clone(), String::new(), "c".into(), long.clone()];
        figure.title = long.clone();
        figure.caption = long;
        let image = figure.draw().unwrap();
        let teal = Colour::hex(0x2c728e).to_rgba8();
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
