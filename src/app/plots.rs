//! Plots against simulated time, and of any quantity against any other, for the window and for pictures of them.

use std::sync::Arc;

use egui::{Color32, ComboBox, Label, RichText, Ui};
use egui_plot::{
    AxisHints, GridInput, GridMark, HoverPosition, Line, LineStyle, MarkerShape, Plot, PlotPoints,
    PlotUi, Points, VLine,
};
use serde::{Deserialize, Serialize};

use super::ensemble::Band;
use crate::data::Observed;
use crate::live::Curve;
use crate::render::numbers::{decimal, si_prefix, ticks};
use crate::sim::{Beside, Observables, Quantity};

/// Least width of a plot, points: below it fewer are shown in a row.
const LEAST_WIDTH: f32 = 150.0;
/// What an axis of slump shows at least: runs are compared by eye.
const LEAST_SLUMP: f64 = 0.4;
/// Least height of a vertical axis, as a part of its largest value.
const LEAST_SPAN: f64 = 1e-3;
/// The same of one that is logarithmic: two powers of ten are within it wherever it lies.
const LEAST_DECADES: f64 = 2.0;
/// The quantity that other piles are told of.
const OTHERS: &str = "slump";
/// How strong the colour of single other piles is.
const OTHERS_STRENGTH: f32 = 0.45;
/// Intervals of time for which a long curve shows its least and its largest value.
const BUCKETS: usize = 300;

/// How what is shown beside a quantity is drawn.
const BESIDE: [LineStyle; 2] =
    [LineStyle::Dashed { length: 6.0 }, LineStyle::Dotted { spacing: 4.0 }];

/// A plot with the look of all of them. The wheel does not zoom it.
pub(super) fn bare_plot<'a>(
    ui: &Ui,
    id: impl std::hash::Hash + std::fmt::Debug,
    height: f32,
) -> Plot<'a> {
    Plot::new(id)
        .height(height)
        .allow_scroll(false)
        // egui would fill it pixel by pixel (see `fill`).
        .show_background(false)
        .grid_color(ui.visuals().widgets.noninteractive.bg_stroke.color)
}

/// A plot with an axis along x in that unit; `log` says which axes are logarithmic.
pub(super) fn plot_with_axes<'a>(
    ui: &Ui,
    id: impl std::hash::Hash + std::fmt::Debug,
    height: f32,
    log: [bool; 2],
    x_unit: &'static str,
) -> Plot<'a> {
    let y_hints = AxisHints::new_y().min_thickness(34.0);
    bare_plot(ui, id, height)
        // Half of the last label lies right of the plot.
        .width(ui.available_width() - 10.0)
        .x_grid_spacer(move |grid| round_marks(grid, log[0]))
        .y_grid_spacer(move |grid| round_marks(grid, log[1]))
        .custom_x_axes(vec![axis(AxisHints::new_x(), log[0], x_unit)])
        .custom_y_axes(vec![axis(y_hints, log[1], "")])
}

/// Everything that plots are drawn from.
#[derive(Clone, Debug)]
pub(crate) struct PlotData {
    pub worlds: Vec<WorldCurve>,
    /// Rows of the run before, behind the others.
    pub ghosts: Vec<Curve>,
    pub quantities: Vec<&'static Quantity<Observables>>,
    pub chosen: ChosenPlot,
    /// The moment that is shown, s.
    pub now_secs: f64,
    /// Plots reach at least to here, s.
    pub until_secs: f64,
}

/// Draws the plots into the space that is left. Returns the time that was clicked, s.
pub(super) fn draw(ui: &mut Ui, data: &PlotData) -> Option<f64> {
    // Plots that left room would shrink their panel, frame by frame.
    ui.set_min_size(ui.available_size());
    let has_chosen = data.chosen.on && data.chosen.title().is_some();
    let mut all: Vec<Option<_>> = data.quantities.iter().copied().map(Some).collect();
    all.extend(has_chosen.then_some(None));
    let count = all.len();
    if count == 0 || data.worlds.is_empty() {
        ui.weak("Choose what to plot.");
        return None;
    }
    let spacing = ui.spacing().item_spacing;
    let fitting = ((ui.available_width() + spacing.x) / (LEAST_WIDTH + spacing.x)).floor();
    // Plots wider than high read best; a high area holds two rows of them.
    let high = ui.available_height() > 0.45 * ui.available_width();
    let most = if high { count.div_ceil(2) } else { count };
    let columns = most.min((fitting as usize).max(1));
    let rows = count.div_ceil(columns);
    let size = egui::vec2(
        (ui.available_width() - spacing.x * (columns - 1) as f32) / columns as f32,
        (ui.available_height() - spacing.y * (rows - 1) as f32) / rows as f32,
    );
    let mut clicked = None;
    for row in all.chunks(columns) {
        ui.horizontal(|ui| {
            for cell in row {
                ui.allocate_ui(size, |ui| {
                    ui.set_min_width(size.x);
                    ui.vertical(|ui| match cell {
                        Some(quantity) => clicked = clicked.or(plot(ui, data, quantity)),
                        None => data.chosen.draw(ui, &data.worlds, data.now_secs),
                    });
                });
            }
        });
    }
    clicked
}

fn plot(ui: &mut Ui, data: &PlotData, quantity: &Quantity<Observables>) -> Option<f64> {
    let (title, factor) = title(data, quantity);
    ui.add(Label::new(RichText::new(title).small()).truncate());
    let log = quantity.logarithmic;
    let group = egui::Id::unique("time");
    let [least, most] = least_span(data, quantity, factor);
    let height = (ui.available_height() - 2.0).max(40.0);
    let until_secs = end_secs(data);
    let response = plot_with_axes(ui, ("plot", quantity.name), height, [false, log], " s")
        .link_axis(group, [true, false])
        .link_cursor(group, [true, false])
        .allow_zoom([true, false])
        .include_x(0.0)
        .include_x(data.until_secs)
        .include_y(least)
        .include_y(most)
        .label_formatter(move |position| hover_text(position, log))
        .show(ui, |plot| {
            plot.vline(VLine::new("now", data.now_secs).color(Color32::GRAY).width(1.0));
            let scaled = |value: f64| scaled(value, log);
            for ghost in &data.ghosts {
                let shown = |row: &Observables| match row.time_secs <= until_secs {
                    true => scaled((quantity.value)(row)) / factor,
                    false => f64::NAN,
                };
                let values = points(ghost, shown);
                let grey = Color32::from_gray(128).gamma_multiply(0.6);
                plot.line(Line::new("the run before", values).color(grey).width(1.2));
            }
            if quantity.name == OTHERS {
                data.worlds.iter().for_each(|world| others(plot, world, data.now_secs));
            }
            for WorldCurve { name, colour, curve, .. } in &data.worlds {
                let line = |name: String, value: &dyn Fn(&Observables) -> f64| {
                    Line::new(name, points(curve, |row| value(row) / factor)).color(*colour)
                };
                let value = |row: &Observables| scaled((quantity.value)(row));
                plot.line(line(name.clone(), &value).width(1.6));
                for ((what, value), style) in beside(curve, quantity).zip(BESIDE) {
                    let value = |row: &Observables| scaled(value(row).unwrap_or(f64::NAN));
                    plot.line(line(format!("{name}: {what}"), &value).style(style).width(1.2));
                }
            }
            plot.pointer_coordinate()
        });
    response.response.clicked().then_some(response.inner.map(|at| at.x)).flatten()
}

/// Where the axis of time ends, s. A ghost of a long run does not stretch that of a short one.
fn end_secs(data: &PlotData) -> f64 {
    let ends = data.worlds.iter().filter_map(|world| world.curve.last());
    ends.map(|row| row.time_secs).fold(data.until_secs, f64::max)
}

/// What is known of others at the moment that is shown: before a pile is released, nothing is told of how it ends.
fn until_now(points: &[[f64; 2]], now_secs: f64) -> PlotPoints<'static> {
    points.iter().copied().take_while(|point| point[0] <= now_secs).collect()
}

/// A world's other piles as thin lines and their mean as a dashed one, up to the moment that is shown.
fn others(plot: &mut PlotUi<'_>, world: &WorldCurve, now_secs: f64) {
    let Some(band) = world.others.as_ref().filter(|band| band.count > 0) else { return };
    for run in &band.runs {
        let line = Line::new(format!("{}: another pile", world.name), until_now(run, now_secs));
        plot.line(line.color(world.colour.gamma_multiply(OTHERS_STRENGTH)).width(0.8));
    }
    let mean: Vec<_> =
        band.times_secs.iter().zip(&band.means).map(|(&at, &mean)| [at, mean]).collect();
    let name = format!("{}: mean of {} other piles", world.name, band.count);
    let style = LineStyle::Dashed { length: 5.0 };
    plot.line(
        Line::new(name, until_now(&mean, now_secs)).color(world.colour).style(style).width(1.2),
    );
}

/// What a vertical axis shows at least: around values that hardly differ, more than the digits of their rounding.
fn least_span(data: &PlotData, quantity: &Quantity<Observables>, factor: f64) -> [f64; 2] {
    let value = |row: &Observables| (quantity.value)(row);
    let scaled = |value: f64| if quantity.logarithmic { value.log10() } else { value / factor };
    let rows = data.worlds.iter().flat_map(|world| world.curve.rows());
    let values = rows.map(|row| scaled(value(row))).filter(|value| value.is_finite());
    let ends = values.map(|value| [value, value]);
    let ends = ends.reduce(|ends, [value, _]| [ends[0].min(value), ends[1].max(value)]);
    let [mut low, mut high] = ends.unwrap_or_default();
    if quantity.name == OTHERS {
        (low, high) = (low.min(0.0), high.max(LEAST_SLUMP));
    }
    let most = low.abs().max(high.abs());
    let least = if quantity.logarithmic { LEAST_DECADES } else { LEAST_SPAN * most };
    let room = (0.5 * (least - (high - low))).max(0.0);
    [low - room, high + room]
}

/// What a curve has to show beside a quantity.
fn beside(
    curve: &Curve,
    quantity: &Quantity<Observables>,
) -> impl Iterator<Item = Beside<Observables>> {
    let has = |beside: &Beside<Observables>| curve.rows().any(|row| beside.1(row).is_some());
    quantity.beside.iter().copied().filter(has)
}

/// The title of a plot, and what its values are divided by for the prefix of their unit.
fn title(data: &PlotData, quantity: &Quantity<Observables>) -> (String, f64) {
    let mut title = quantity.title.to_owned();
    let mut factor = 1.0;
    if !quantity.unit.is_empty() {
        let others = quantity.beside.iter();
        let largest = |row: &Observables| {
            let others = others.clone().filter_map(|(_, value)| value(row));
            others.fold((quantity.value)(row), f64::max)
        };
        let curves = data.worlds.iter().map(|world| &world.curve).chain(&data.ghosts);
        let rows = curves.flat_map(Curve::rows);
        let prefix;
        (prefix, factor) = si_prefix(rows.map(largest).fold(0.0, f64::max));
        title = format!("{title} ({prefix}{})", quantity.unit);
    }
    let has_more = |curve: &Curve| beside(curve, quantity).next().is_some();
    if data.worlds.iter().any(|world| has_more(&world.curve)) {
        let styles = ["dashed", "dotted"].iter().zip(quantity.beside);
        let said: Vec<_> = styles.map(|(style, (name, _))| format!("{style}: {name}")).collect();
        title = format!("{title}; {}", said.join(", "));
    }
    (title, factor)
}

/// Two to five marks at round numbers, or at whole powers of ten.
fn round_marks(grid: GridInput, log: bool) -> Vec<GridMark> {
    let (low, high) = grid.bounds;
    if log {
        let marks = |step: i64| {
            let ends = [low, high].map(|end| end / step as f64);
            ends[0].ceil() as i64..=ends[1].floor() as i64
        };
        let widest = (((high - low) / 3.0).ceil() as i64).max(1);
        let step = (1..=widest).rev().find(|&step| marks(step).count() > 1).unwrap_or(1);
        let step_size = step as f64;
        let mark = |count: i64| GridMark { value: count as f64 * step_size, step_size };
        return marks(step).map(mark).collect();
    }
    let (values, step_size) = ticks(low, high, 4);
    values.into_iter().map(|value| GridMark { value, step_size }).collect()
}

/// Labels of the marks: numbers, or the powers of ten that numbers stand for.
fn axis(hints: AxisHints<'static>, log: bool, unit: &'static str) -> AxisHints<'static> {
    hints.label_spacing(10.0..=18.0).formatter(move |mark, _| {
        if log {
            return format!("1e{}", mark.value);
        }
        format!("{}{unit}", decimal(mark.value, mark.step_size))
    })
}

fn hover_text(position: &HoverPosition<'_>, log: bool) -> Option<String> {
    let HoverPosition::NearDataPoint { plot_name: name, position: at, .. } = position else {
        return None;
    };
    let value = if log { format!("{:.1e}", 10f64.powf(at.y)) } else { format!("{:.4}", at.y) };
    Some(format!("{name}\n{:.4} s\n{value}", at.x))
}

/// The logarithm of a value along a logarithmic axis.
fn scaled(value: f64, log: bool) -> f64 {
    if log { value.log10() } else { value }
}

/// The curve, or, of a long one, the least and the largest value of every interval.
fn points(curve: &Curve, value: impl Fn(&Observables) -> f64) -> PlotPoints<'static> {
    let points = curve.rows().map(|row| [row.time_secs, value(row)]);
    // A state that no step has led to has no residual, and its logarithm is no number.
    let is_finite = |point: &[f64; 2]| point.iter().all(|number| number.is_finite());
    let points: Vec<[f64; 2]> = points.filter(is_finite).collect();
    if curve.len() <= 2 * BUCKETS {
        return points.into();
    }
    let extremes = points.chunks(curve.len().div_ceil(BUCKETS)).flat_map(|bucket| {
        let by_value = |one: &&[f64; 2], other: &&[f64; 2]| one[1].total_cmp(&other[1]);
        let ends = [bucket.iter().min_by(by_value), bucket.iter().max_by(by_value)];
        let mut ends = ends.map(|end| *end.unwrap_or(&bucket[0]));
        ends.sort_by(|one, other| one[0].total_cmp(&other[0]));
        ends
    });
    extremes.collect()
}

/// What is plotted of a world.
#[derive(Clone, Debug)]
pub(crate) struct WorldCurve {
    /// What tells it from the others.
    pub name: String,
    pub colour: Color32,
    pub curve: Curve,
    /// What other piles slump with its settings.
    pub others: Option<Arc<Band>>,
}

/// Points of a curve at the most.
const MOST_POINTS: usize = 2_000;

/// What is plotted against what.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ChosenPlot {
    /// True while it shows.
    pub on: bool,
    /// Names of the quantities along the axes, as tables call them: x and y.
    pub axes: [String; 2],
    /// True where equal distances along an axis are equal factors.
    pub logarithmic: [bool; 2],
}

impl Default for ChosenPlot {
    fn default() -> Self {
        let axes = ["slump", "kinetic_energy"].map(str::to_owned);
        Self { on: false, axes, logarithmic: [false; 2] }
    }
}

impl ChosenPlot {
    /// The two boxes and switches that choose.
    pub(super) fn choose(&mut self, ui: &mut Ui) {
        for (axis, name) in [(1, "y"), (0, "x")] {
            let shown = ComboBox::from_id_salt(("axis", axis)).width(118.0);
            let chosen = &mut self.axes[axis];
            let list = shown.selected_text(chosen.replace('_', " ")).show_ui(ui, |ui| {
                for observed in Observed::all() {
                    let title = observed.title();
                    let entry = ui.selectable_label(*chosen == observed.name(), title);
                    if entry.on_hover_text(observed.about()).clicked() {
                        *chosen = observed.name().to_owned();
                    }
                }
            });
            let label = format!("Quantity along {name}");
            list.response
                .widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, &label));
            ui.toggle_value(&mut self.logarithmic[axis], format!("log {name}"))
                .on_hover_text("Equal distances are equal factors; values up to 0 do not show.");
        }
    }

    /// Its title; nothing where it is of what there is not.
    pub(super) fn title(&self) -> Option<String> {
        let [x, y] = self.axes.each_ref().map(|name| Observed::named(name));
        Some(format!("{} against {}", y?.title(), x?.title()))
    }

    /// The places of rows, as the plot has them.
    fn points<'a>(&self, rows: impl Iterator<Item = &'a Observables>) -> Vec<[f64; 2]> {
        let [Some(x), Some(y)] = self.axes.each_ref().map(|name| Observed::named(name)) else {
            return Vec::new();
        };
        let scaled = |axis: usize, value: f64| scaled(value, self.logarithmic[axis]);
        let place = |row: &Observables| {
            let place = [scaled(0, x.of(row)?), scaled(1, y.of(row)?)];
            place.iter().all(|at| at.is_finite()).then_some(place)
        };
        rows.filter_map(place).collect()
    }

    /// Draws it; the moment that is shown has a dot.
    pub(super) fn draw(&self, ui: &mut Ui, worlds: &[WorldCurve], now_secs: f64) {
        let title = RichText::new(self.title().unwrap_or_default()).small();
        ui.add(Label::new(title).truncate());
        let id = ("chosen", &self.axes, self.logarithmic);
        let height = (ui.available_height() - 2.0).max(40.0);
        plot_with_axes(ui, id, height, self.logarithmic, "").show(ui, |plot| {
            for WorldCurve { name, colour, curve, .. } in worlds {
                let stride = curve.len().div_ceil(MOST_POINTS).max(1);
                let points = self.points(curve.rows().step_by(stride));
                plot.line(Line::new(name.clone(), points).color(*colour).width(1.4));
                let until_now = |row: &&Observables| row.time_secs <= now_secs;
                let now = curve.rows().take_while(until_now).last();
                let place = self.points(now.into_iter());
                let dot = Points::new(name.clone(), PlotPoints::from(place));
                plot.points(dot.shape(MarkerShape::Circle).radius(4.0).color(*colour));
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_goes_through_the_rows_and_leaves_out_what_has_no_logarithm() {
        let row = |(slump, kinetic_energy)| Observables {
            slump,
            kinetic_energy,
            ..Observables::default()
        };
        let rows = [(0.0, 1.0), (0.1, 10.0), (0.2, 0.0)].map(row);
        let mut plot = ChosenPlot::default();
        assert_eq!(plot.points(rows.iter()), [[0.0, 1.0], [0.1, 10.0], [0.2, 0.0]]);
        plot.logarithmic = [false, true];
        assert_eq!(plot.points(rows.iter()), [[0.0, 0.0], [0.1, 1.0]]);
        assert_eq!(plot.title().unwrap(), "kinetic energy (J) against slump");
        // What only some laws have is not there under others.
        plot.axes[1] = "bond_energy".into();
        assert!(plot.points(rows.iter()).is_empty());
        plot.axes[1] = "of another version".into();
        assert!(plot.points(rows.iter()).is_empty() && plot.title().is_none());
    }

    fn curve_until(end_secs: f64) -> Curve {
        let mut curve = Curve::default();
        for (step, time_secs) in [0.0, 0.5 * end_secs, end_secs].into_iter().enumerate() {
            curve.push(Observables { step: step as u64, time_secs, ..Observables::default() });
        }
        curve
    }

    #[test]
    fn a_ghost_of_a_long_run_does_not_stretch_the_axis_of_a_short_one() {
        let world = WorldCurve {
            name: String::new(),
            colour: Color32::RED,
            curve: curve_until(1.5),
            others: None,
        };
        let data = PlotData {
            worlds: vec![world],
            ghosts: vec![curve_until(9.0)],
            quantities: Vec::new(),
            chosen: ChosenPlot::default(),
            now_secs: 0.0,
            until_secs: 1.0,
        };
        assert_eq!(end_secs(&data), 1.5, "its own end alone counts");
        assert_eq!(end_secs(&PlotData { worlds: Vec::new(), ..data }), 1.0);
    }

    #[test]
    fn the_end_of_other_piles_is_not_told_before_the_release() {
        let points = [[0.0, 0.0], [0.1, 0.2], [0.2, 0.4]];
        let shown = |now_secs| until_now(&points, now_secs).points().len();
        assert_eq!([shown(0.0), shown(0.15), shown(1.0)], [1, 2, 3]);
    }

    #[test]
    fn an_axis_never_has_one_number_alone() {
        let grid = |low, high| GridInput { bounds: (low, high), base_step_size: 1.0 };
        for place in 0..400 {
            let low = -7.3 + 0.037 * f64::from(place);
            for span in [1e-6, 1e-3, 0.4, 1.0, 2.0, 3.2, 5.7, 6.1, 9.0, 1e3] {
                let count = round_marks(grid(low, low + span), false).len();
                assert!((2..=5).contains(&count), "{low} and {span} more: {count}");
                if span >= LEAST_DECADES {
                    let count = round_marks(grid(low, low + span), true).len();
                    assert!((2..=5).contains(&count), "1e{low} and {span} decades more: {count}");
                }
            }
        }
    }

    #[test]
    fn every_quantity_that_steps_measure_can_be_chosen() {
        let row = Observables::default().with_further_columns();
        assert!(Observed::all().all(|observed| observed.of(&row).is_some()));
    }
}
