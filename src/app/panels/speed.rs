//! Panel: how long methods take to solve a step how well, as `slump chart` measured it, and where the
//! present run is on that chart.

use std::sync::OnceLock;

use egui::{RichText, Ui};
use egui_plot::{Legend, Line, LineStyle, MarkerShape, Plot, PlotPoint, PlotPoints, Points};
use serde::Deserialize;

use crate::app::state::AppState;
use crate::app::theme;

/// What `slump chart` wrote as `chart-window.csv`.
const CHART: &str = include_str!("../../../assets/charts/chart-window.csv");
/// Height of the plot, points.
const HEIGHT: f32 = 230.0;
/// Colours before dashes tell curves apart.
const COLOURS: usize = 6;

/// A point of the table.
#[derive(Deserialize)]
struct Row {
    method: String,
    residual: f64,
    ms_per_step: f64,
}

/// The curve of a method: log₁₀ of ms a step and of the residual.
struct Curve {
    method: String,
    points: Vec<PlotPoint>,
}

/// The shipped chart: its caption, and its curves. What is no row of the table is left out.
fn chart() -> &'static (String, Vec<Curve>) {
    static PARSED: OnceLock<(String, Vec<Curve>)> = OnceLock::new();
    PARSED.get_or_init(|| {
        let caption = CHART.lines().next().unwrap_or_default().trim_start_matches("# ");
        let mut reader =
            csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(CHART.as_bytes());
        let mut curves: Vec<Curve> = Vec::new();
        for Row { method, residual, ms_per_step } in reader.deserialize().flatten() {
            let point = PlotPoint::new(ms_per_step.log10(), residual.log10());
            match curves.last_mut() {
                Some(curve) if curve.method == method => curve.points.push(point),
                _ => curves.push(Curve { method, points: vec![point] }),
            }
        }
        (caption.to_owned(), curves)
    })
}

/// Shows the panel.
pub(crate) fn show(ui: &mut Ui, state: &mut AppState) {
    let dark = ui.visuals().dark_mode;
    let (caption, curves) = chart();
    let worlds = state.frame.worlds.iter().enumerate().filter_map(|(index, world)| {
        let residual = world.snapshot.observables.residual;
        let told = world.step_ms > 0.0 && residual > 0.0;
        told.then(|| (super::compare::title(state, index), index, world.step_ms, residual))
    });
    let worlds: Vec<_> = worlds.collect();
    ui.label(RichText::new("residual against ms a step").small());
    Plot::new("speed and accuracy")
        .height(HEIGHT)
        .allow_scroll(false)
        .allow_drag(false)
        .allow_zoom(false)
        .show_background(false)
        .grid_color(ui.visuals().widgets.noninteractive.bg_stroke.color)
        .legend(Legend::default().text_style(egui::TextStyle::Small))
        .x_axis_formatter(|mark, _| power_of_ten(mark.value))
        .y_axis_formatter(|mark, _| power_of_ten(mark.value))
        .show(ui, |plot| {
            for (index, Curve { method, points }) in curves.iter().enumerate() {
                let colour = theme::world_colour(index, dark);
                let points: PlotPoints<'_> = points.iter().map(|at| [at.x, at.y]).collect();
                let dashed = LineStyle::dashed_loose();
                let style = if index < COLOURS { LineStyle::Solid } else { dashed };
                plot.line(Line::new(method.clone(), points).color(colour).style(style).width(1.6));
            }
            for (name, index, ms, residual) in &worlds {
                let place = PlotPoints::new(vec![[ms.log10(), residual.log10()]]);
                let dot = Points::new(format!("now: {name}"), place)
                    .shape(MarkerShape::Diamond)
                    .radius(7.0)
                    .color(theme::world_colour(*index, dark));
                plot.points(dot);
            }
        });
    for (name, _, ms, residual) in &worlds {
        ui.label(format!("{name}: {ms:.3} ms a step, residual {residual:.1e}"));
    }
    if worlds.is_empty() {
        ui.weak("The run shows here from its first step on.");
    }
    ui.label(RichText::new(caption).small().weak());
}

fn power_of_ten(exponent: f64) -> String {
    if exponent.fract() == 0.0 { format!("1e{exponent}") } else { String::new() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::METHODS;

    #[test]
    fn the_shipped_chart_is_of_methods_that_there_are() {
        let (caption, curves) = chart();
        assert!(caption.contains("slump chart"), "{caption}");
        assert!(curves.iter().any(|curve| curve.method == "newton"));
        for Curve { method, points } in curves {
            let name = method.split(' ').next().unwrap_or_default();
            assert!(METHODS.iter().any(|info| info.name == name), "{method}");
            assert!(points.windows(2).all(|pair| pair[1].y < pair[0].y), "{method} falls");
        }
    }
}
