//! Draws sheets of charts with the crate plotters, in the font that is included in the program.

use std::ops::Range;
use std::sync::OnceLock;

use image::RgbImage;
use plotters::coord::Shift;
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::prelude::*;

use super::even_lines::EvenLines;
use super::{Axis, Chart, INK, Layer, Look, MapCell, Point, Rgb, Sheet};
use crate::error::{Error, Result};
use crate::output::Texts;
use crate::png::png_of_rgb;

/// Font size of the title of a chart, pixels.
const TITLE: u32 = 27;
/// Font size of the labels of axes, pixels.
const WORDS: u32 = 24;
/// Font size of the caption of a sheet of charts, pixels.
const CAPTION: u32 = 20;
/// Font size of text within a chart, pixels.
const WITHIN: u32 = 18;
/// Least width of the space to the left of a vertical axis, in which its labels are, pixels.
const BESIDE: u32 = 104;
/// Width of a character, pixels, from which the space for long labels of a vertical axis and for the names in the
/// legend is computed.
const CHARACTER: u32 = 12;
/// Space above the first entry of the legend, pixels.
const ABOVE: u32 = 70;
/// Height of a line of text in the caption and in the legend, pixels.
const CAPTION_LINE: u32 = 28;
/// Space between two entries of the legend, pixels.
const BETWEEN: u32 = 8;
/// Width of the legend without the names of its entries, pixels.
const KEY: u32 = 70;
/// Width of a character of the caption, pixels, from which the length of its lines is computed.
const CAPTION_CHARACTER: u32 = 10;
/// Half the height of a horizontal bar, as a fraction of the height of its row.
const BAR: f64 = 0.32;
/// Name of the font of all charts. Browsers also know this name, so that they can display the text of an SVG file.
const FONT: &str = "sans-serif";

type Context<'a, DB> = ChartContext<'a, DB, Cartesian2d<AxisCoordinates, AxisCoordinates>>;

/// Returns a sheet of charts as a PNG file, which also contains the command that draws the sheet.
///
/// # Errors
/// If plotters or the encoder fails.
pub fn png(sheet: &Sheet, command: &str) -> Result<Vec<u8>> {
    let layout = Layout::of(sheet);
    let (width, height) = layout.size;
    let mut pixels = vec![0; 3 * width as usize * height as usize];
    let bitmap = BitMapBackend::with_buffer(&mut pixels, layout.size);
    draw(&layout, EvenLines(bitmap).into_drawing_area())?;
    let image = RgbImage::from_raw(width, height, pixels)
        .ok_or_else(|| failed("the picture has another size"))?;
    let mut texts = Texts::default();
    texts.add("Command line", command);
    png_of_rgb(&image, &texts)
}

/// Returns a sheet of charts as an SVG file.
///
/// # Errors
/// If plotters fails.
pub fn svg(sheet: &Sheet) -> Result<String> {
    let layout = Layout::of(sheet);
    let mut text = String::new();
    draw(&layout, SVGBackend::with_string(&mut text, layout.size).into_drawing_area())?;
    Ok(text)
}

/// Layout of a sheet of charts: the charts, a legend to their right, and the caption below.
struct Layout<'a> {
    sheet: &'a Sheet,
    size: (u32, u32),
    /// Entries of the legend: name, colour and style of each curve. Each name occurs once.
    legend: Vec<(&'a str, Rgb, Look)>,
    caption: Vec<String>,
}

impl<'a> Layout<'a> {
    fn of(sheet: &'a Sheet) -> Self {
        let mut legend: Vec<(&str, Rgb, Look)> = Vec::new();
        for layer in sheet.charts.iter().flat_map(|chart| &chart.layers) {
            if let Layer::Curve { name, in_legend: true, colour, look, .. } = layer
                && legend.iter().all(|(known, ..)| known != name)
            {
                legend.push((name, *colour, *look));
            }
        }
        let lines = || legend.iter().flat_map(|(name, ..)| name.split('\n'));
        let longest = lines().map(|line| line.chars().count()).max();
        let beside = longest.map_or(0, |longest| KEY + CHARACTER * longest as u32);
        let width = sheet.size.0 + beside;
        let most = (width / CAPTION_CHARACTER) as usize;
        let caption: Vec<String> =
            sheet.caption.iter().flat_map(|line| wrapped(line, most)).collect();
        let entries = CAPTION_LINE * lines().count() as u32 + BETWEEN * legend.len() as u32;
        let height = sheet.size.1.max(ABOVE + entries) + CAPTION_LINE * caption.len() as u32 + 8;
        Self { sheet, size: (width, height), legend, caption }
    }
}

/// Breaks a text between words into lines of at most `most` characters. A longer word gets its own line.
fn wrapped(words: &str, most: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in words.split(' ') {
        match lines.last_mut() {
            Some(line) if line.is_empty() => word.clone_into(line),
            Some(line) if line.chars().count() + 1 + word.chars().count() <= most => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

fn failed(error: impl std::fmt::Display) -> Error {
    Error::file("figure", format!("cannot be drawn ({error})"))
}

fn register_fonts() -> Result<()> {
    static DONE: OnceLock<bool> = OnceLock::new();
    let regular = include_bytes!("../../../../assets/fonts/DejaVuSansCondensed.ttf");
    // The browser version of the program draws no charts, so it does not register a font.
    #[cfg(target_arch = "wasm32")]
    let register = |_: &[u8]| false;
    #[cfg(not(target_arch = "wasm32"))]
    let register = |font| plotters::style::register_font(FONT, FontStyle::Normal, font).is_ok();
    let done = DONE.get_or_init(|| register(regular));
    if *done { Ok(()) } else { Err(failed("its font is broken")) }
}

fn draw<DB: DrawingBackend>(layout: &Layout<'_>, area: DrawingArea<DB, Shift>) -> Result<()> {
    let Layout { sheet, size, legend, caption } = layout;
    register_fonts()?;
    area.fill(&WHITE).map_err(failed)?;
    let below = size.1 - CAPTION_LINE * caption.len() as u32 - 8;
    let style = (FONT, CAPTION).into_font().color(&RGBColor(90, 90, 90));
    for (line, y) in caption.iter().zip((below as i32..).step_by(CAPTION_LINE as usize)) {
        area.draw_text(line, &style, (16, y)).map_err(failed)?;
    }
    // The charts divide the width of the sheet among themselves in proportion to their own widths.
    let total: f64 = sheet.charts.iter().map(|chart| chart.width).sum();
    let mut before = 0.0;
    for chart in &sheet.charts {
        let edges = [before, before + chart.width];
        let [left, right] = edges.map(|edge| (edge / total * f64::from(sheet.size.0)) as i32);
        before = edges[1];
        draw_chart(chart, &area.clone().shrink((left, 0), (right - left, below as i32)))?;
    }
    draw_legend(legend, &area.clone().shrink((sheet.size.0, 0), (size.0 - sheet.size.0, below)))?;
    area.present().map_err(failed)
}

fn draw_legend<DB: DrawingBackend>(
    legend: &[(&str, Rgb, Look)],
    area: &DrawingArea<DB, Shift>,
) -> Result<()> {
    let style = (FONT, CAPTION + 2).into_font().color(&rgb(INK));
    let mut y = ABOVE as i32;
    for (name, colour, look) in legend {
        let colour = rgb(*colour);
        let (stroke, dot) = strokes(*look, colour);
        let dashes: &[(i32, i32)] = match look {
            Look::Dashes(_) => &[(10, 18), (24, 32), (38, 46)],
            _ => &[(10, 46)],
        };
        for &(start, end) in dashes.iter().filter(|_| stroke > 0) {
            let dash = PathElement::new(vec![(start, y), (end, y)], colour.stroke_width(stroke));
            area.draw(&dash).map_err(failed)?;
        }
        if let Some((radius, style)) = dot {
            area.draw(&Circle::new((28, y), radius, style)).map_err(failed)?;
        }
        for part in name.split('\n') {
            area.draw_text(part, &style, (58, y - 11)).map_err(failed)?;
            y += CAPTION_LINE as i32;
        }
        y += BETWEEN as i32;
    }
    Ok(())
}

fn draw_chart<DB: DrawingBackend>(chart: &Chart, area: &DrawingArea<DB, Shift>) -> Result<()> {
    let (x_places, y_places) = (AxisCoordinates::of(&chart.x), AxisCoordinates::of(&chart.y));
    let words = (FONT, WORDS).into_font().color(&rgb(INK));
    let mut builder = ChartBuilder::on(area);
    let longest = chart.y.ticks.iter().map(|(_, words)| words.chars().count()).max();
    let beside = BESIDE.max(CHARACTER * longest.unwrap_or(0) as u32 + WORDS);
    builder.margin(14).margin_right(26).x_label_area_size(62).y_label_area_size(beside);
    if !chart.title.is_empty() {
        builder.caption(&chart.title, (FONT, TITLE).into_font().color(&rgb(INK)));
    }
    let mut context = builder.build_cartesian_2d(x_places, y_places).map_err(failed)?;
    context
        .configure_mesh()
        .bold_line_style(RGBColor(228, 228, 228))
        .light_line_style(TRANSPARENT)
        .x_desc(&chart.x.label)
        .y_desc(&chart.y.label)
        .label_style(words.clone())
        .axis_desc_style(words.clone())
        .draw()
        .map_err(failed)?;

    chart.layers.iter().try_for_each(|layer| draw_layer(chart, layer, &mut context))
}

fn draw_layer<'a, DB: DrawingBackend + 'a>(
    chart: &Chart,
    layer: &Layer,
    context: &mut Context<'a, DB>,
) -> Result<()> {
    let place = |x: f64, y: f64| (chart.x.scale.place(x), chart.y.scale.place(y));
    match layer {
        Layer::Words { at: (x, y), text, colour } => {
            let style = (FONT, WITHIN).into_font().color(&rgb(*colour));
            let words = Text::new(text.clone(), place(*x, *y), style);
            context.draw_series([words]).map_err(failed)?;
        }
        Layer::Cells { cells, colour, .. } => {
            let rectangles = cells.iter().map(|MapCell { x: (_, x), y: (_, y), value }| {
                let corners = [place(x[0], y[0]), place(x[1], y[1])];
                Rectangle::new(corners, rgb(colour(*value)).filled())
            });
            context.draw_series(rectangles).map_err(failed)?;
        }
        Layer::Curve { points, colour, look: Look::Bars, .. } => {
            let bar = |Point { x, y, .. }: &Point| {
                let corners = [place(0.0, y - BAR), place(*x, y + BAR)];
                Rectangle::new(corners, rgb(*colour).mix(0.6).filled())
            };
            context.draw_series(points.iter().map(bar)).map_err(failed)?;
            let lines = points.iter().filter_map(|Point { y, interval, .. }| {
                let (low, high) = (*interval)?;
                Some(PathElement::new(
                    vec![place(low, *y), place(high, *y)],
                    rgb(INK).stroke_width(2),
                ))
            });
            context.draw_series(lines).map_err(failed)?;
        }
        Layer::Curve { points, colour, look, aside, .. } => {
            let colour = rgb(*colour);
            let width = place(chart.x.to, 1.0).0 - place(chart.x.from, 1.0).0;
            let place = |x: f64, y: f64| {
                let (x, y) = place(x, y);
                (x + aside * width, y)
            };
            let bars = points.iter().filter_map(|point| {
                let (low, high) = point.interval?;
                let bar = vec![place(point.x, low), place(point.x, high)];
                Some(PathElement::new(bar, colour.stroke_width(2)))
            });
            context.draw_series(bars).map_err(failed)?;
            let line = points.iter().map(|point| place(point.x, point.y)).collect();
            draw_curve(line, colour, *look, context)?;
        }
    }
    Ok(())
}

fn draw_curve<'a, DB: DrawingBackend + 'a>(
    line: Vec<(f64, f64)>,
    colour: RGBColor,
    look: Look,
    context: &mut Context<'a, DB>,
) -> Result<()> {
    let (stroke, dot) = strokes(look, colour);
    let style = colour.stroke_width(stroke);
    if matches!(look, Look::Line(_) | Look::LineAndDots) {
        context.draw_series(LineSeries::new(line.clone(), style)).map_err(failed)?;
    }
    if matches!(look, Look::Dashes(_)) {
        let dashes = DashedLineSeries::new(line.clone(), 8, 6, style);
        context.draw_series(dashes).map_err(failed)?;
    }
    if let Some((radius, style)) = dot {
        let dots = line.iter().map(|place| Circle::new(*place, radius, style));
        context.draw_series(dots).map_err(failed)?;
    }
    Ok(())
}

/// Returns how a curve is drawn in this style: the width of its line, pixels (0 without a line), and the radius,
/// pixels, and plotters style of its dots (`None` without dots).
fn strokes(look: Look, colour: RGBColor) -> (u32, Option<(u32, ShapeStyle)>) {
    match look {
        Look::Line(width) | Look::Dashes(width) => (width, None),
        Look::LineAndDots => (3, Some((5, colour.filled()))),
        // This width is only used in the legend. On a chart, bars are drawn as rectangles.
        Look::Bars => (14, None),
        Look::Dots(radius) => (0, Some((radius, colour.filled()))),
        Look::Rings(radius) => (0, Some((radius, colour.stroke_width(2)))),
    }
}

fn rgb((red, green, blue): Rgb) -> RGBColor {
    RGBColor(red, green, blue)
}

/// Tolerance for the labels of an axis, as a fraction of its length: a coordinate gets the label of a tick mark if
/// their distance is at most this tolerance.
const NEAR: f64 = 1e-6;

/// An axis as the crate plotters needs it: the range of the coordinates along the axis (logarithms on a logarithmic
/// axis), and the tick marks.
struct AxisCoordinates {
    range: Range<f64>,
    marks: Vec<(f64, String)>,
}

impl AxisCoordinates {
    fn of(axis: &Axis) -> Self {
        let place = |number| axis.scale.place(number);
        let marks = if axis.ticks.is_empty() {
            axis.scale.marks(axis.from, axis.to)
        } else {
            axis.ticks.clone()
        };
        Self {
            range: place(axis.from)..place(axis.to),
            marks: marks.into_iter().map(|(number, words)| (place(number), words)).collect(),
        }
    }
}

impl Ranged for AxisCoordinates {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (from, to): (i32, i32)) -> i32 {
        let share = (value - self.range.start) / (self.range.end - self.range.start);
        // Points beyond an end of the axis are drawn at that end.
        from + (f64::from(to - from) * share.clamp(0.0, 1.0)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() {
            return Vec::new();
        }
        self.marks.iter().map(|(place, _)| *place).collect()
    }

    fn range(&self) -> Range<f64> {
        self.range.clone()
    }
}

impl ValueFormatter<f64> for AxisCoordinates {
    fn format_ext(&self, place: &f64) -> String {
        // The axis may be reversed, so its length is an absolute value.
        let span = (self.range.end - self.range.start).abs();
        let mark = self.marks.iter().find(|(mark, _)| (mark - place).abs() < NEAR * span);
        mark.map_or(String::new(), |(_, words)| words.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sheet_has_room_for_its_legend_and_lines_of_its_caption_are_not_cut() {
        let nowhere = Axis::linear("", 0.0, 1.0);
        let mut sheet = Sheet::of(Chart::new("", nowhere.clone(), nowhere));
        assert_eq!(Layout::of(&sheet).size, (1200, 828));
        sheet.caption = vec!["ten words ".repeat(30)];
        for number in 0..40 {
            let name = format!("method {number}\nof two lines");
            sheet.charts[0].layers.push(Layer::curve(name, Vec::new(), INK, Look::Line(1)));
        }
        let layout = Layout::of(&sheet);
        assert_eq!(layout.size.1, 70 + 40 * (2 * 28 + 8) + 28 * 3 + 8);
        assert!(layout.caption.iter().all(|line| 10 * line.len() <= layout.size.0 as usize));
    }
}
