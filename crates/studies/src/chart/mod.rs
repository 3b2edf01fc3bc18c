//! Describes charts as plain data, independent of how they are drawn. PNG, SVG and CSV files are made from the same
//! data, so the CSV file contains every point.

mod draw;
mod even_lines;
mod fronts;

pub use draw::{png, svg};
pub use fronts::pareto_front;

use crate::error::{Error, Result};

/// A colour: red, green and blue, 0 … 255 each.
pub type Rgb = (u8, u8, u8);

pub(crate) const INK: Rgb = (40, 40, 40);
/// Colours of curves that people with any type of colour vision can distinguish (Okabe and Ito 2008).
pub const PALETTE: [Rgb; 7] = [
    (0, 0, 0),
    (0, 114, 178),
    (230, 159, 0),
    (0, 158, 115),
    (204, 121, 167),
    (86, 180, 233),
    (213, 94, 0),
];

/// Horizontal shift between two curves with the same x values, as a fraction of the width of the chart. The shift makes
/// the confidence intervals of both curves visible side by side.
const ASIDE: f64 = 0.006;

/// One axis of a chart.
#[derive(Clone, Debug)]
pub struct Axis {
    pub(crate) label: String,
    pub(crate) scale: Scale,
    pub(crate) from: f64,
    pub(crate) to: f64,
    /// Values at which the axis has tick marks, with their labels. If the list is empty, the marks are at round
    /// numbers.
    pub(crate) ticks: Vec<(f64, String)>,
}

impl Axis {
    /// Returns a linear axis with the values `from` and `to` at its ends.
    pub fn linear(label: impl Into<String>, from: f64, to: f64) -> Self {
        Self { label: label.into(), scale: Scale::Linear, from, to, ticks: Vec::new() }
    }

    /// Returns a logarithmic axis with the values `from` and `to` at its ends.
    pub fn log(label: impl Into<String>, from: f64, to: f64) -> Self {
        Self { label: label.into(), scale: Scale::Log, from, to, ticks: Vec::new() }
    }
}

/// A point of a curve on a chart, with its confidence interval if it has one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Coordinate on the x axis.
    pub x: f64,
    /// Coordinate on the y axis.
    pub y: f64,
    /// Lower and upper end of the confidence interval in y.
    pub interval: Option<(f64, f64)>,
}

/// Returns points of a curve, without confidence intervals, from pairs of coordinates (x, y).
pub(crate) fn points(places: impl IntoIterator<Item = (f64, f64)>) -> Vec<Point> {
    places.into_iter().map(|(x, y)| Point { x, y, interval: None }).collect()
}

/// A filled rectangle of a map, a chart that shows a value over x and y by colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapCell {
    /// Value on the x axis that the rectangle represents, and the x values of its left and right edges.
    pub x: (f64, [f64; 2]),
    /// Value on the y axis that the rectangle represents, and the y values of its lower and upper edges.
    pub y: (f64, [f64; 2]),
    /// Value that the colour of the rectangle shows.
    pub value: f64,
}

/// Style in which a curve is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    /// A line of this width, pixels.
    Line(u32),
    /// A dashed line of this width, pixels.
    Dashes(u32),
    /// Filled discs of this radius, pixels.
    Dots(u32),
    /// Empty circles of this radius, pixels.
    Rings(u32),
    /// A line through filled discs.
    LineAndDots,
    /// Horizontal bars from 0 to x, with confidence intervals in x.
    Bars,
}

/// One layer of a chart: a curve, filled rectangles, or a text label.
#[derive(Clone, Debug)]
pub enum Layer {
    /// A curve: points, with or without lines between them.
    Curve {
        /// Name of the curve in the CSV file, and in the legend if `in_legend` is true.
        name: String,
        /// True if the curve is in the legend.
        in_legend: bool,
        /// Points of the curve, in the order in which a line connects them.
        points: Vec<Point>,
        /// Colour of the curve.
        colour: Rgb,
        /// Style of the curve.
        look: Look,
        /// Horizontal shift of the curve, as a fraction of the width of the chart, so that the confidence intervals of
        /// several curves do not hide each other.
        aside: f64,
    },
    /// Filled rectangles, each with the value that its colour shows.
    Cells {
        /// Name of the rectangles in the CSV file.
        name: String,
        /// The rectangles.
        cells: Vec<MapCell>,
        /// Function that returns the colour of a value.
        colour: fn(f64) -> Rgb,
    },
    /// A text label within the chart.
    Words {
        /// Position at which the text begins: values on the x axis and on the y axis.
        at: (f64, f64),
        /// The text.
        text: String,
        /// Colour of the text.
        colour: Rgb,
    },
}

impl Layer {
    /// Returns a curve that is in the legend.
    pub fn curve(name: impl Into<String>, points: Vec<Point>, colour: Rgb, look: Look) -> Self {
        Self::Curve { name: name.into(), in_legend: true, points, colour, look, aside: 0.0 }
    }

    /// Returns this curve with a small horizontal shift. `index` is its number, from 0, among `count` curves with the
    /// same x values, which are shifted so that their confidence intervals do not hide each other.
    pub fn beside(mut self, index: usize, count: usize) -> Self {
        if let Self::Curve { aside, .. } = &mut self {
            *aside = ASIDE * (index as f64 - 0.5 * (count as f64 - 1.0));
        }
        self
    }

    /// Returns a curve that is not in the legend.
    pub fn quiet(name: impl Into<String>, points: Vec<Point>, colour: Rgb, look: Look) -> Self {
        Self::Curve { name: name.into(), in_legend: false, points, colour, look, aside: 0.0 }
    }
}

/// A chart: a pair of axes with its layers of curves, cells and labels.
#[derive(Clone, Debug)]
pub struct Chart {
    pub(crate) title: String,
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    /// Layers of the chart, from back to front.
    pub layers: Vec<Layer>,
    /// Width of the chart relative to the other charts on the same sheet. The charts of a sheet are side by side.
    pub(crate) width: f64,
}

impl Chart {
    /// Returns a chart with the given title and axes, still without curves.
    pub fn new(title: impl Into<String>, x: Axis, y: Axis) -> Self {
        Self { title: title.into(), x, y, layers: Vec::new(), width: 1.0 }
    }
}

/// A sheet: charts side by side, with a legend of all curves to their right and a caption below.
#[derive(Clone, Debug)]
pub struct Sheet {
    /// Width and height of all charts together, without legend and caption, pixels.
    pub size: (u32, u32),
    /// The charts, from left to right.
    pub charts: Vec<Chart>,
    /// Lines of the caption below the charts.
    pub caption: Vec<String>,
}

impl Sheet {
    pub(crate) fn of(chart: Chart) -> Self {
        Self { size: (1200, 820), charts: vec![chart], caption: Vec::new() }
    }

    /// Returns every point of every layer of the charts as CSV, with the columns panel (number of the chart), layer, x,
    /// y, low, high and value.
    ///
    /// # Errors
    /// If a row cannot be written as CSV.
    pub fn to_csv(&self) -> Result<Vec<u8>> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let refuse = |error: csv::Error| Error::file("figure", error);
        let names = ["panel", "layer", "x", "y", "low", "high", "value"].map(str::to_owned);
        writer.write_record(names).map_err(refuse)?;
        for (chart, panel) in self.charts.iter().zip(1..) {
            for layer in &chart.layers {
                let (name, rows): (_, Vec<[Option<f64>; 5]>) = match layer {
                    Layer::Curve { name, points, .. } => {
                        let row = |Point { x, y, interval }: &Point| {
                            let (low, high) = interval.unzip();
                            [Some(*x), Some(*y), low, high, None]
                        };
                        (name, points.iter().map(row).collect())
                    }
                    Layer::Cells { name, cells, .. } => {
                        let row = |cell: &MapCell| {
                            [Some(cell.x.0), Some(cell.y.0), None, None, Some(cell.value)]
                        };
                        (name, cells.iter().map(row).collect())
                    }
                    Layer::Words { .. } => continue,
                };
                for row in rows {
                    let cells =
                        row.map(|cell| cell.map_or_else(String::new, |cell| cell.to_string()));
                    let named = [panel.to_string(), name.replace('\n', " ")];
                    writer.write_record(named.into_iter().chain(cells)).map_err(refuse)?;
                }
            }
        }
        writer.into_inner().map_err(|error| Error::file("figure", error.error()))
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scale {
    Linear,
    Log,
}

const MARKS: f64 = 6.0;

/// Ratio of the values at the two ends of a logarithmic axis, below which not only powers of ten get labels, but also 2
/// and 5 times these powers.
const SHORT: f64 = 80.0;

impl Scale {
    /// Returns the coordinate of a number along the axis: the number itself, or its decimal logarithm on a logarithmic
    /// axis.
    fn place(self, number: f64) -> f64 {
        match self {
            Self::Linear => number,
            Self::Log => number.max(f64::MIN_POSITIVE).log10(),
        }
    }

    /// Returns the round numbers between two ends of an axis, at which tick marks are drawn, with their labels. Minor
    /// tick marks have empty labels.
    fn marks(self, from: f64, to: f64) -> Vec<(f64, String)> {
        match self {
            Self::Linear => linear_marks(from, to),
            Self::Log => log_marks(from, to),
        }
    }
}

fn linear_marks(from: f64, to: f64) -> Vec<(f64, String)> {
    let rough = (to - from) / MARKS;
    let power = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|digit| digit * power).into_iter();
    let step = step.min_by(|a, b| (a - rough).abs().total_cmp(&(b - rough).abs())).unwrap_or(power);
    let decimals = (-step.log10().floor()).max(0.0) as usize;
    let first = (from / step - 1e-9).ceil() as i64;
    let last = (to / step + 1e-9).floor() as i64;
    (first..=last)
        .map(|index| index as f64 * step)
        .map(|number| (number, format!("{number:.decimals$}").replace('-', "−")))
        .collect()
}

fn log_marks(from: f64, to: f64) -> Vec<(f64, String)> {
    let (first, last) = (from.log10().floor() as i32, to.log10().ceil() as i32);
    let mut marks = Vec::new();
    for exponent in first..=last {
        for digit in 1..10 {
            let number = f64::from(digit) * 10f64.powi(exponent);
            if number >= from * (1.0 - 1e-9) && number <= to * (1.0 + 1e-9) {
                let words = match digit {
                    1 => power_of_ten(exponent),
                    2 | 5 if to < SHORT * from && PLAIN.contains(&exponent) => format!("{number}"),
                    2 | 5 if to < SHORT * from => format!("{digit}·{}", power_of_ten(exponent)),
                    _ => String::new(),
                };
                marks.push((number, words));
            }
        }
    }
    marks
}

/// Exponents of those powers of ten that are written as decimals.
const PLAIN: std::ops::RangeInclusive<i32> = -2..=2;

/// Formats a power of ten: as 10⁻⁴, for example, or as a decimal from 0.01 to 100.
fn power_of_ten(exponent: i32) -> String {
    if PLAIN.contains(&exponent) {
        return format!("{}", 10f64.powi(exponent));
    }
    let digits = exponent.to_string();
    let raised = digits.chars().map(|sign| match sign {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        digit => char::from_u32('⁰' as u32 + digit.to_digit(10).unwrap_or(0)).unwrap_or(digit),
    });
    format!("10{}", raised.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_round_numbers() {
        let words = |scale: Scale, from, to| -> Vec<String> {
            let marks = scale.marks(from, to).into_iter().map(|(_, words)| words);
            marks.filter(|words| !words.is_empty()).collect()
        };
        assert_eq!(
            words(Scale::Linear, 0.0, 0.6),
            ["0.0", "0.1", "0.2", "0.3", "0.4", "0.5", "0.6"]
        );
        assert_eq!(
            words(Scale::Linear, -10.0, 5.0),
            ["−10", "−8", "−6", "−4", "−2", "0", "2", "4"]
        );
        assert_eq!(
            words(Scale::Log, 8e-5, 6e-3),
            ["10⁻⁴", "2·10⁻⁴", "5·10⁻⁴", "10⁻³", "2·10⁻³", "5·10⁻³"]
        );
        assert_eq!(words(Scale::Log, 1e-12, 1e-11), ["10⁻¹²", "2·10⁻¹²", "5·10⁻¹²", "10⁻¹¹"]);
        assert_eq!(words(Scale::Log, 2.0, 100.0), ["2", "5", "10", "20", "50", "100"]);
        assert_eq!(words(Scale::Log, 1e-4, 1e-2), ["10⁻⁴", "10⁻³", "0.01"]);
    }
}
