//! Sheets drawn by plotters, with the font that comes with the program.

use std::ops::Range;
use std::sync::OnceLock;

use image::RgbImage;
use plotters::coord::Shift;
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::prelude::*;
use plotters::style::register_font;

use super::{
    Axis, CAPTION_LINE, Chart, INK, LEGEND, Layer, LegendCorner, Look, MapCell, Rgb, Sheet,
};
use crate::error::{Error, Result};
use crate::output::Texts;
use crate::png::png_of_rgb;

/// Sizes of words, pixels.
const TITLE: u32 = 27;
const WORDS: u32 = 24;
const CAPTION: u32 = 20;
/// Room for the words beside the vertical axis, and for each character of longer ones, pixels.
const BESIDE: u32 = 104;
const CHARACTER: u32 = 12;
/// Name that the font goes by; one that browsers know too, for the SVG.
const FONT: &str = "sans-serif";

/// A pair of axes with what is drawn on them.
type Context<'a, DB> = ChartContext<'a, DB, Cartesian2d<AxisCoordinates, AxisCoordinates>>;

/// The sheet as PNG, which says of itself which command draws it.
///
/// # Errors
/// Where plotters or the encoder fails.
pub fn png(sheet: &Sheet, command: &str) -> Result<Vec<u8>> {
    let (width, height) = sheet.size;
    let mut pixels = vec![0; 3 * width as usize * height as usize];
    draw(sheet, BitMapBackend::with_buffer(&mut pixels, sheet.size).into_drawing_area())?;
    let image = RgbImage::from_raw(width, height, pixels)
        .ok_or_else(|| failed("the picture has another size"))?;
    let mut texts = Texts::default();
    texts.add("Command line", command);
    png_of_rgb(&image, &texts)
}

/// The sheet as SVG.
///
/// # Errors
/// Where plotters fails.
pub fn svg(sheet: &Sheet) -> Result<String> {
    let mut text = String::new();
    draw(sheet, SVGBackend::with_string(&mut text, sheet.size).into_drawing_area())?;
    Ok(text)
}

fn failed(error: impl std::fmt::Display) -> Error {
    Error::file("figure", format!("cannot be drawn ({error})"))
}

fn register_fonts() -> Result<()> {
    static DONE: OnceLock<bool> = OnceLock::new();
    let regular = include_bytes!("../../../../assets/fonts/DejaVuSansCondensed.ttf");
    let done = DONE.get_or_init(|| register_font(FONT, FontStyle::Normal, regular).is_ok());
    if *done { Ok(()) } else { Err(failed("its font is broken")) }
}

fn draw<DB: DrawingBackend>(sheet: &Sheet, area: DrawingArea<DB, Shift>) -> Result<()> {
    register_fonts()?;
    area.fill(&WHITE).map_err(failed)?;
    let height = sheet.size.1;
    let caption_height = CAPTION_LINE * sheet.caption.len() as u32 + 8;
    let (charts, caption) = area.split_vertically(height - caption_height);
    for (number, line) in sheet.caption.iter().enumerate() {
        let at = (16, (CAPTION_LINE * number as u32) as i32);
        let style = (FONT, CAPTION).into_font().color(&RGBColor(90, 90, 90));
        caption.draw_text(line, &style, at).map_err(failed)?;
    }
    // Charts share the width by their own.
    let total: f64 = sheet.charts.iter().map(|chart| chart.width).sum();
    let mut before = 0.0;
    for chart in &sheet.charts {
        let edges = [before, before + chart.width];
        let [left, right] = edges.map(|edge| (edge / total * f64::from(sheet.size.0)) as i32);
        before = edges[1];
        let panel =
            &charts.clone().shrink((left, 0), (right - left, (height - caption_height) as i32));
        if chart.only_legend {
            draw_legend(chart, panel)?;
        } else {
            draw_chart(chart, panel)?;
        }
    }
    area.present().map_err(failed)
}

/// The names of a chart's curves, one below the other.
fn draw_legend<DB: DrawingBackend>(chart: &Chart, area: &DrawingArea<DB, Shift>) -> Result<()> {
    let style = (FONT, CAPTION + 2).into_font().color(&rgb(INK));
    let [above, line_height, between] = LEGEND.map(|room| room as i32);
    let mut y = above;
    for layer in &chart.layers {
        let Layer::Curve { name, colour, look, .. } = layer else { continue };
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
            let radius = if matches!(look, Look::Dots(_)) { radius.max(6) } else { radius };
            area.draw(&Circle::new((28, y), radius, style)).map_err(failed)?;
        }
        for part in name.split('\n') {
            area.draw_text(part, &style, (58, y - 11)).map_err(failed)?;
            y += line_height;
        }
        y += between;
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

    let mut has_legend = false;
    for layer in &chart.layers {
        draw_layer(chart, layer, &mut context)?;
        has_legend |= matches!(layer, Layer::Curve { in_legend: true, .. });
    }
    if !has_legend {
        return Ok(());
    }
    let position = match chart.legend {
        LegendCorner::UpperLeft => SeriesLabelPosition::UpperLeft,
        LegendCorner::UpperRight => SeriesLabelPosition::UpperRight,
        LegendCorner::LowerLeft => SeriesLabelPosition::LowerLeft,
        LegendCorner::LowerRight => SeriesLabelPosition::LowerRight,
    };
    context
        .configure_series_labels()
        .position(position)
        .margin(12)
        .legend_area_size(36)
        .background_style(WHITE.mix(0.85))
        .border_style(RGBColor(200, 200, 200))
        .label_font((FONT, CAPTION + 2).into_font().color(&rgb(INK)))
        .draw()
        .map_err(failed)
}

fn draw_layer<'a, DB: DrawingBackend + 'a>(
    chart: &Chart,
    layer: &Layer,
    context: &mut Context<'a, DB>,
) -> Result<()> {
    let place = |x: f64, y: f64| (chart.x.scale.place(x), chart.y.scale.place(y));
    match layer {
        Layer::Words { at: (x, y), text, colour } => {
            let style = (FONT, CAPTION).into_font().color(&rgb(*colour));
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
        Layer::Curve { name, in_legend, points, colour, look, aside } => {
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
            draw_curve(line, colour, *look, in_legend.then_some(name), context)?;
        }
    }
    Ok(())
}

/// Draws a curve through places of the axes, and names it in the legend if it has a name.
fn draw_curve<'a, DB: DrawingBackend + 'a>(
    line: Vec<(f64, f64)>,
    colour: RGBColor,
    look: Look,
    name: Option<&String>,
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
    let Some(name) = name else { return Ok(()) };
    // Two dashes that touch are a line.
    let dash = if matches!(look, Look::Dashes(_)) { 11 } else { 14 };
    let key = move |(x, y): (i32, i32)| {
        // Without a line there is none in the key either.
        let seen = if stroke > 0 { 1.0 } else { 0.0 };
        let style = colour.mix(seen).stroke_width(stroke.max(1));
        let first = PathElement::new(vec![(x, y), (x + dash, y)], style);
        let second = PathElement::new(vec![(x + 28 - dash, y), (x + 28, y)], style);
        let (radius, style) = dot.unwrap_or((0, colour.mix(0.0).filled()));
        let middle = Circle::new((x + 14, y), radius.min(8), style);
        EmptyElement::at((0, 0)) + first + second + middle
    };
    let nothing: [EmptyElement<(f64, f64), DB>; 0] = [];
    context.draw_series(nothing).map_err(failed)?.label(name).legend(key);
    Ok(())
}

/// Width of a look's line, 0 where it has none, and radius and style of its dots.
fn strokes(look: Look, colour: RGBColor) -> (u32, Option<(u32, ShapeStyle)>) {
    match look {
        Look::Line(width) | Look::Dashes(width) => (width, None),
        Look::LineAndDots => (3, Some((5, colour.filled()))),
        Look::Dots(radius) => (0, Some((radius, colour.filled()))),
        Look::Rings(radius) => (0, Some((radius, colour.stroke_width(2)))),
    }
}

fn rgb((red, green, blue): Rgb) -> RGBColor {
    RGBColor(red, green, blue)
}

/// A mark this near, in units of the axis, is the one that is meant.
const NEAR: f64 = 1e-6;

/// Coordinates along an axis (`Scale::place`) and the marks at it.
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
        // What lies off the axis is drawn at its end.
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
        let span = self.range.end - self.range.start;
        let mark = self.marks.iter().find(|(mark, _)| (mark - place).abs() < NEAR * span);
        mark.map_or(String::new(), |(_, words)| words.clone())
    }
}
