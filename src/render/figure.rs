//! Several pictures as one figure, arranged as a journal does: a grid of panels with labels.
//!
//! Every label is laid out before anything is placed, and the grid takes the room that the labels
//! need. So nothing is cut and nothing overlaps, whatever the words are: long ones break at spaces,
//! and a word too long for its place becomes smaller.

use image::RgbaImage;

use super::Theme;
use crate::error::{Error, Result};

/// A grid of panels, filled row by row.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
    /// Pictures of one size, at most `rows` × `columns`.
    pub panels: Vec<RgbaImage>,
    /// Title of each panel; none where the list ends early or the title is empty.
    pub panel_titles: Vec<String>,
    /// Whether panel titles lie in the panels' upper left corners instead of above them.
    pub titles_inside: bool,
    /// Labels at the left of the rows, reading upwards.
    pub row_labels: Vec<String>,
    /// Labels above the columns.
    pub column_labels: Vec<String>,
    /// Title above everything, bold.
    pub title: String,
    /// Caption below everything.
    pub caption: String,
    /// Whether panels have thin frames.
    pub frames: bool,
    /// Ground and ink.
    pub theme: Theme,
    /// Font size, pixels; from the width of the grid if absent.
    pub text_px: Option<f32>,
}

impl Figure {
    /// A grid without labels, on white, with frames.
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
            frames: true,
            theme: Theme::Light,
            text_px: None,
        }
    }

    /// Checks the lists against the grid; gives the size of a panel.
    pub(super) fn validate(&self) -> Result<(u32, u32)> {
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
        let size = first.dimensions();
        if let Some(other) = self.panels.iter().find(|panel| panel.dimensions() != size) {
            let (width, height) = other.dimensions();
            let allowed = format!("{}x{} like the first", size.0, size.1);
            return Err(Error::value("panels", format!("{width}x{height}"), allowed));
        }
        Ok(size)
    }

    /// 18 px at 1600 px width, but readable on small grids too.
    pub(super) fn text_size(&self, grid_width: u32) -> f32 {
        self.text_px.unwrap_or_else(|| (grid_width as f32 / 88.0).clamp(14.0, 48.0).round())
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
        let mut figure = Figure::new(1, 2, panels(3));
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
        let mut figure = Figure::new(2, 2, panels(4));
        figure.frames = false;
        let long = "a label that is far too long for its place in the grid".to_owned();
        figure.row_labels = vec![long.clone(), long.clone()];
        figure.column_labels = vec![long.clone(), "short".into()];
        figure.panel_titles = vec![long.clone(), String::new(), "c".into(), long.clone()];
        figure.title = long.clone();
        figure.caption = long;
        let image = figure.draw().unwrap();
        let teal = Colour::hex(0x2c728e).to_rgba8();
        let covered = image.pixels().filter(|pixel| **pixel == teal).count();
        assert_eq!(covered, 4 * 120 * 80, "no label may cover a panel");
        // The outermost pixels stay free, so no label is cut.
        let (width, height) = image.dimensions();
        let white = Colour::WHITE.to_rgba8();
        assert!((0..width).all(|x| *image.get_pixel(x, 0) == white));
        assert!((0..width).all(|x| *image.get_pixel(x, height - 1) == white));
        assert!((0..height).all(|y| *image.get_pixel(0, y) == white));
        assert!((0..height).all(|y| *image.get_pixel(width - 1, y) == white));
    }
}
