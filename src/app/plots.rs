//! Plots against simulated time, in the window and in saved pictures.

use std::sync::Arc;

use egui::{Color32, Label, RichText, Ui};
use egui_plot::{HoverPosition, Line, LineStyle, VLine};

use super::axes::{plot_with_axes, with_room};
use super::curve_pieces::{interval_secs, pieces, solid, thinned};
use super::ensemble::Band;
use super::glossary::explained;
use super::number_text::clock_text;
use crate::live::Curve;
use crate::render::numbers::si_prefix;
use crate::sim::{Beside, Observables, Quantity};

/// Smallest width of a plot, points. In a narrower window a row has fewer plots.
pub(super) const LEAST_WIDTH: f32 = 150.0;
/// Smallest length of a slump axis. Most slumps are smaller, so the axes of most runs are equal and easy to compare.
pub(super) const LEAST_SLUMP: f64 = 0.4;
/// Name of the quantity that is also plotted for runs from other initial states (other seeds).
const OTHERS: &str = "slump";
/// Colour strength of the curves of runs from other initial states, relative to the curve of the visible run.
const OTHERS_STRENGTH: f32 = 0.45;

/// Line styles of the first and second additional curve in a plot, such as the mean next to the largest overlap.
const BESIDE: [LineStyle; 2] =
    [LineStyle::Dashed { length: 6.0 }, LineStyle::Dotted { spacing: 4.0 }];

/// Data from which all plots are drawn.
#[derive(Clone, Debug)]
pub(crate) struct PlotData {
    pub worlds: Vec<WorldCurve>,
    /// Curves of the earlier run's simulations, drawn behind those of the present simulations.
    pub ghosts: Vec<WorldCurve>,
    pub quantities: Vec<&'static Quantity<Observables>>,
    /// The displayed simulated time, s.
    pub now_secs: f64,
    /// Simulated time that the time axis reaches at least, s.
    pub until_secs: f64,
}

/// Draws plots for a saved picture. If there are several simulations, a key of their colours is above the plots.
pub(super) fn draw_with_key(ui: &mut Ui, data: &PlotData) {
    if data.worlds.len() > 1 {
        ui.horizontal_wrapped(|ui| {
            for WorldCurve { name, colour, .. } in &data.worlds {
                ui.label(RichText::new("■").color(*colour));
                ui.label(name);
            }
        });
    }
    draw(ui, data);
}

/// Draws the plots into the remaining space. Returns the simulated time at which the user clicked, s.
pub(super) fn draw(ui: &mut Ui, data: &PlotData) -> Option<f64> {
    // If the plots left space, their panel would become smaller from frame to frame.
    ui.set_min_size(ui.available_size());
    let count = data.quantities.len();
    if count == 0 || data.worlds.is_empty() {
        ui.weak("Choose what to plot.");
        return None;
    }
    let spacing = ui.spacing().item_spacing;
    let fitting = ((ui.available_width() + spacing.x) / (LEAST_WIDTH + spacing.x)).floor();
    // Plots are easiest to read if they are wider than high, so a high area has two rows of plots.
    let high = ui.available_height() > 0.45 * ui.available_width();
    let most = if high { count.div_ceil(2) } else { count };
    let columns = most.min((fitting as usize).max(1));
    let rows = count.div_ceil(columns);
    let size = egui::vec2(
        (ui.available_width() - spacing.x * (columns - 1) as f32) / columns as f32,
        (ui.available_height() - spacing.y * (rows - 1) as f32) / rows as f32,
    );
    let mut clicked = None;
    for row in data.quantities.chunks(columns) {
        ui.horizontal(|ui| {
            for quantity in row {
                ui.allocate_ui(size, |ui| {
                    ui.set_min_width(size.x);
                    ui.vertical(|ui| clicked = clicked.or(plot(ui, data, quantity)));
                });
            }
        });
    }
    clicked
}

fn plot(ui: &mut Ui, data: &PlotData, quantity: &Quantity<Observables>) -> Option<f64> {
    let (title, factor) = title(data, quantity);
    let label = Label::new(RichText::new(&title).small()).truncate();
    // A line of the height of a button, as above the plot of slump against Δt.
    explained(ui.horizontal(|ui| ui.add(label)).inner, &title);
    let log = quantity.logarithmic;
    let group = egui::Id::unique("time");
    let until_secs = end_secs(data);
    // A logarithmic axis has no unit, so its factor is 1.
    let scaled = |value: f64| if log { value.log10() } else { value / factor };
    let value = |row: &Observables| scaled((quantity.value)(row));
    let values = data.worlds.iter().flat_map(|world| world.curve.rows()).map(value);
    let always: &[f64] = if quantity.name == OTHERS { &[0.0, LEAST_SLUMP] } else { &[] };
    let ends = [[0.0, data.until_secs], with_room(values.chain(always.iter().copied()), log)];
    let response = plot_with_axes(ui, ("plot", quantity.name), [false, log], " ms", ends)
        .link_axis(group, [true, false])
        .link_cursor(group, [true, false])
        .allow_zoom([true, false])
        .label_formatter(move |position| hover_text(position, log))
        .show(ui, |plot| {
            let interval_secs = interval_secs(plot);
            plot.vline(VLine::new("now", data.now_secs).color(Color32::GRAY).width(1.0));
            for ghost in &data.ghosts {
                for piece in pieces(&ghost.curve, until_secs, interval_secs, value) {
                    plot.line(solid(ghost.name.clone(), piece).color(ghost.colour).width(1.2));
                }
            }
            if quantity.name == OTHERS {
                let worlds = data.ghosts.iter().chain(&data.worlds);
                let lines = worlds.flat_map(|world| others(world, data.now_secs, interval_secs));
                lines.for_each(|line| plot.line(line));
            }
            for WorldCurve { name, colour, curve, .. } in &data.worlds {
                for piece in pieces(curve, f64::INFINITY, interval_secs, value) {
                    plot.line(solid(name.clone(), piece).color(*colour).width(1.6));
                }
                for ((what, value), style) in beside(curve, quantity).zip(BESIDE) {
                    let value = |row: &Observables| scaled(value(row).unwrap_or(f64::NAN));
                    for piece in pieces(curve, f64::INFINITY, interval_secs, value) {
                        let line = Line::new(format!("{name}: {what}"), piece);
                        plot.line(line.color(*colour).style(style).width(1.2));
                    }
                }
            }
            plot.pointer_coordinate()
        });
    response.response.clicked().then_some(response.inner.map(|at| at.x)).flatten()
}

/// Returns the end of the time axis, s. The earlier run (ghost) may be longer; it does not extend the axis.
fn end_secs(data: &PlotData) -> f64 {
    let ends = data.worlds.iter().filter_map(|world| world.curve.last());
    ends.map(|row| row.time_secs).fold(data.until_secs, f64::max)
}

/// Returns lines that show the slumps of runs from other initial states with the settings of the simulation `world`, up
/// to the displayed time `now_secs`: a thin line per run, and their mean as a dashed line. Later slumps must not be
/// visible yet.
fn others(world: &WorldCurve, now_secs: f64, interval_secs: f64) -> Vec<Line<'static>> {
    let Some(band) = world.others.as_ref().filter(|band| band.count > 0) else {
        return Vec::new();
    };
    let shown = |points: &[[f64; 2]]| {
        let until_now = points.partition_point(|point| point[0] <= now_secs);
        thinned(&points[..until_now], interval_secs)
    };
    let run = |run: &(usize, Vec<[f64; 2]>)| {
        let line = solid(format!("{}: another pile", world.name), shown(&run.1));
        line.color(world.colour.gamma_multiply(OTHERS_STRENGTH)).width(0.8)
    };
    let mean: Vec<_> =
        band.times_secs.iter().zip(&band.means).map(|(&at, &mean)| [at, mean]).collect();
    let name = format!("{}: mean of {} other piles", world.name, band.count);
    let style = LineStyle::Dashed { length: 5.0 };
    let mean = Line::new(name, shown(&mean)).color(world.colour);
    band.runs.iter().map(run).chain([mean.style(style).width(1.2)]).collect()
}

/// Returns the additional curves (dashed, dotted) in the plot of a quantity, if this run has values for them.
fn beside(
    curve: &Curve,
    quantity: &Quantity<Observables>,
) -> impl Iterator<Item = Beside<Observables>> {
    let has = |beside: &Beside<Observables>| curve.rows().any(|row| beside.1(row).is_some());
    quantity.beside.iter().copied().filter(has)
}

/// Returns the title of a plot, and the factor of its unit's prefix (1e3 for k), by which the values are divided.
fn title(data: &PlotData, quantity: &Quantity<Observables>) -> (String, f64) {
    let mut title = quantity.title.to_owned();
    let mut factor = 1.0;
    if !quantity.unit.is_empty() {
        let others = quantity.beside.iter();
        let largest = |row: &Observables| {
            let others = others.clone().filter_map(|(_, value)| value(row));
            others.fold((quantity.value)(row), f64::max)
        };
        let worlds = data.worlds.iter().chain(&data.ghosts);
        let rows = worlds.flat_map(|world| world.curve.rows());
        let prefix;
        (prefix, factor) = si_prefix(rows.map(largest).fold(0.0, f64::max));
        title = format!("{title} ({prefix}{})", quantity.unit);
    }
    let mut rows = data.worlds.iter().flat_map(|world| world.curve.rows());
    if quantity.logarithmic && rows.any(|row| row.step > 0 && (quantity.value)(row) == 0.0) {
        title += "; gaps are zeros";
    }
    let has_more = |curve: &Curve| beside(curve, quantity).next().is_some();
    if data.worlds.iter().any(|world| has_more(&world.curve)) {
        let styles = ["dashed", "dotted"].iter().zip(quantity.beside);
        let said: Vec<_> = styles.map(|(style, (name, _))| format!("{style}: {name}")).collect();
        title = format!("{title}; {}", said.join(", "));
    }
    (title, factor)
}

fn hover_text(position: &HoverPosition<'_>, log: bool) -> Option<String> {
    let HoverPosition::NearDataPoint { plot_name: name, position: at, .. } = position else {
        return None;
    };
    let value = if log { format!("{:.1e}", 10f64.powf(at.y)) } else { format!("{:.4}", at.y) };
    Some(format!("{name}\n{}\n{value}", clock_text(at.x)))
}

/// Curves of one simulation.
#[derive(Clone, Debug)]
pub(crate) struct WorldCurve {
    /// Title that distinguishes the simulation from the other simulations.
    pub name: String,
    pub colour: Color32,
    pub curve: Curve,
    /// Slumps of runs with the settings of this simulation from other initial states.
    pub others: Option<Arc<Band>>,
}

#[cfg(test)]
mod tests {
    use egui_plot::{PlotGeometry, PlotItem};

    use super::*;
    use crate::sim::QUANTITIES;

    fn curve_until(end_secs: f64) -> Curve {
        let mut curve = Curve::default();
        for (step, time_secs) in [0.0, 0.5 * end_secs, end_secs].into_iter().enumerate() {
            curve.push(Observables { step: step as u64, time_secs, ..Observables::default() });
        }
        curve
    }

    fn world(curve: Curve) -> WorldCurve {
        WorldCurve { name: String::new(), colour: Color32::RED, curve, others: None }
    }

    fn plots_of(world: WorldCurve, ghosts: Vec<WorldCurve>) -> PlotData {
        PlotData {
            worlds: vec![world],
            ghosts,
            quantities: Vec::new(),
            now_secs: 0.0,
            until_secs: 1.0,
        }
    }

    #[test]
    fn a_ghost_of_a_long_run_does_not_stretch_the_axis_of_a_short_one() {
        let data = plots_of(world(curve_until(1.5)), vec![world(curve_until(9.0))]);
        assert_eq!(end_secs(&data), 1.5, "its own end alone counts");
        assert_eq!(end_secs(&PlotData { worlds: Vec::new(), ..data.clone() }), 1.0);
        let ghost = &data.ghosts[0].curve;
        let shown = |until_secs| pieces(ghost, until_secs, 0.01, |_| 1.0)[0].len();
        assert_eq!([shown(1.5), shown(4.5), shown(9.0)], [1, 2, 3], "and nothing beyond is drawn");
    }

    #[test]
    fn other_piles_are_a_line_each_and_their_mean_and_none_tells_its_end_before() {
        let times_secs = vec![0.0, 0.1, 0.2];
        let run = |slope: f64| (0, times_secs.iter().map(|at| [*at, slope * at]).collect());
        let band = Band {
            runs: [1.0, 2.0, 6.0].map(run).into(),
            means: times_secs.iter().map(|at| 3.0 * at).collect(),
            count: 3,
            times_secs: times_secs.clone(),
            ..Band::default()
        };
        let world = WorldCurve { others: Some(Arc::new(band)), ..world(curve_until(0.2)) };
        for (now_secs, points) in [(0.0, 1), (0.15, 2), (1.0, 3)] {
            let ends: Vec<f64> = others(&world, now_secs, 0.01)
                .iter()
                .map(|line| {
                    let PlotGeometry::Points(all) = line.geometry() else { panic!("no points") };
                    assert_eq!(all.len(), points, "at {now_secs} s");
                    all[points - 1].y
                })
                .collect();
            let last = times_secs[points - 1];
            assert_eq!(ends, [1.0, 2.0, 6.0, 3.0].map(|slope| slope * last));
        }
        let alone = WorldCurve { others: None, ..world };
        assert!(others(&alone, 1.0, 0.01).is_empty());
    }

    #[test]
    fn the_title_says_why_a_logarithmic_plot_has_gaps() {
        let error = QUANTITIES.iter().find(|quantity| quantity.name == "error").unwrap();
        let of_errors = |errors: [f64; 3]| {
            let mut curve = Curve::default();
            for (step, velocity_error) in errors.into_iter().enumerate() {
                let step = step as u64;
                curve.push(Observables { step, velocity_error, ..Observables::default() });
            }
            title(&plots_of(world(curve), Vec::new()), error).0
        };
        assert!(of_errors([0.0, 1e-6, 0.0]).ends_with("; gaps are zeros"));
        assert!(!of_errors([0.0, 1e-6, 1e-7]).contains("gaps"), "no step leads to the start");
    }

    /// Draws the plots, and counts the numbers along the x axis and along the y axis.
    fn painted_numbers(data: &PlotData) -> [usize; 2] {
        let context = egui::Context::default();
        let mut painted = Vec::new();
        // Plots adapt their size during the first frames.
        for _ in 0..4 {
            let size = egui::vec2(500.0, 260.0);
            let screen_rect = Some(egui::Rect::from_min_size(egui::Pos2::ZERO, size));
            let input = egui::RawInput { screen_rect, ..egui::RawInput::default() };
            let mut output = context.run_ui(input, |ui| {
                draw(ui, data);
            });
            output.textures_delta.clear();
            painted = output.shapes;
        }
        let mut counts = [0, 0];
        for clipped in painted {
            let egui::Shape::Text(text) = clipped.shape else { continue };
            let number = text.galley.text().trim_end_matches(" ms").replace('−', "-");
            if number.parse::<f64>().is_ok() {
                counts[usize::from(text.visual_bounding_rect().center().y < 240.0)] += 1;
            }
        }
        counts
    }

    #[test]
    fn both_axes_of_every_plot_have_numbers() {
        for values in [
            [1.0, 1.0, 1.0],
            [1.0, 1.01, 3.0],
            [2e-7, 6e-7, 3e-7],
            [0.0, 5e3, 7e9],
            [0.0, 1.0, 1e200],
        ] {
            let mut curve = Curve::default();
            for (step, value) in values.into_iter().enumerate() {
                curve.push(Observables {
                    step: step as u64,
                    time_secs: 0.1 * step as f64,
                    slump: value,
                    kinetic_energy: value,
                    residual: value,
                    ..Observables::default()
                });
            }
            let data = plots_of(world(curve), Vec::new());
            for quantity in QUANTITIES {
                let data = PlotData { quantities: vec![quantity], ..data.clone() };
                let counts = painted_numbers(&data);
                assert!(
                    counts.iter().all(|&count| count >= 2),
                    "{}: {counts:?} of {values:?}",
                    quantity.name
                );
            }
        }
    }
}
