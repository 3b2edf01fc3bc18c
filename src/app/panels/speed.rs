//! Panel: how long methods take to solve a step how well: the step that is shown, where that has been measured, or
//! those that `slump chart` measured.

use std::sync::OnceLock;

use egui::{Color32, RichText, Ui};
use egui_plot::{GridMark, Line, LineStyle, MarkerShape, PlotPoint, PlotPoints, Points};
use serde::Deserialize;

use crate::app::plots::still_plot;
use crate::app::state::AppState;
use crate::app::step_race::StepRace;
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
    measure(ui, state);
    let (caption, shipped) = chart();
    let Some(race) = &state.race else {
        let names: Vec<&str> = shipped.iter().map(|curve| curve.method.as_str()).collect();
        let curves: Vec<_> = shipped.iter().map(|curve| curve.points.clone()).collect();
        draw(ui, &curves, None);
        legend(ui, &names);
        ui.label(RichText::new(format!("Not of this scene: {caption}")).small().weak());
        return readings(ui, state);
    };
    let names: Vec<&str> = race.curves.iter().map(|curve| curve.method).collect();
    let point = |&[ms, residual]: &[f64; 2]| PlotPoint::new(ms.log10(), residual.log10());
    let curves = race.curves.iter().map(|curve| curve.points.iter().map(point).collect());
    let curves: Vec<Vec<PlotPoint>> = curves.collect();
    draw(ui, &curves, now(state, race));
    legend(ui, &names);
    let how = if race.is_over { "measured here" } else { "being measured" };
    let text = format!(
        "The step that follows t = {:.4} s, {how}; ◆ is the present method.",
        race.time_secs
    );
    ui.label(RichText::new(text).small().weak());
    readings(ui, state);
}

/// The button that measures the step that is shown.
fn measure(ui: &mut Ui, state: &mut AppState) {
    if let Some(race) = &mut state.race {
        race.look();
    }
    let is_under_way = state.race.as_ref().is_some_and(|race| !race.is_over);
    let can = state.world().is_some_and(|world| {
        world.failure.is_none() && world.controls.settings.stepper.uses_method()
    });
    ui.horizontal(|ui| {
        let button = ui.add_enabled(can && !is_under_way, egui::Button::new("Measure this step"));
        let hint = "Each method solves the step that is shown, to one tolerance after the other: some seconds.";
        let button = button.on_hover_text(hint);
        if button.on_disabled_hover_text("There is no method to measure, or it is being done.").clicked() {
            let time_secs = state.world().map_or(0.0, |world| world.snapshot.observables.time_secs);
            let run = state.take_run();
            state.race = Some(StepRace::start(run, time_secs, ui.ctx().clone()));
        }
        if is_under_way {
            ui.spinner();
        }
    });
}

/// Where the present method is on the chart of its own step: the run's own mean time, once it is at that step.
fn now(state: &AppState, race: &StepRace) -> Option<[f64; 2]> {
    let world = state.world()?;
    let row = &world.snapshot.observables;
    let is_of_step = (row.time_secs - race.time_secs).abs() < 2.0 * row.time_step_secs;
    let told = is_of_step && world.step_ms > 0.0 && row.residual > 0.0;
    told.then(|| [world.step_ms.log10(), row.residual.log10()])
}

fn draw(ui: &mut Ui, curves: &[Vec<PlotPoint>], now: Option<[f64; 2]>) {
    let dark = ui.visuals().dark_mode;
    ui.label(RichText::new("residual against ms a step").small());
    still_plot(ui, "speed and accuracy", HEIGHT)
        .x_grid_spacer(|grid| decades(grid.bounds))
        .y_grid_spacer(|grid| decades(grid.bounds))
        .x_axis_formatter(|mark, _| power_of_ten(mark.value))
        .y_axis_formatter(|mark, _| power_of_ten(mark.value))
        .show(ui, |plot| {
            for (index, points) in curves.iter().enumerate() {
                let (colour, style) = look(index, dark);
                let places: PlotPoints<'_> = points.iter().map(|at| [at.x, at.y]).collect();
                plot.line(Line::new("", places).color(colour).style(style).width(1.6));
            }
            if let Some(place) = now {
                let ink = if dark { Color32::WHITE } else { Color32::BLACK };
                let dot = Points::new("now", PlotPoints::new(vec![place]));
                plot.points(dot.shape(MarkerShape::Diamond).radius(6.0).color(ink));
            }
        });
}

/// Colour and stroke of a curve, which no other one has.
fn look(index: usize, dark: bool) -> (Color32, LineStyle) {
    let style = match index / COLOURS {
        0 => LineStyle::Solid,
        1 => LineStyle::dashed_loose(),
        _ => LineStyle::dotted_dense(),
    };
    (theme::world_colour(index % COLOURS, dark), style)
}

/// What colours and strokes mean, below the chart, of which it hides nothing.
fn legend(ui: &mut Ui, names: &[&str]) {
    let dark = ui.visuals().dark_mode;
    ui.horizontal_wrapped(|ui| {
        for (index, name) in names.iter().enumerate() {
            let (colour, _) = look(index, dark);
            let stroke = ["━", "╍", "┉"][(index / COLOURS).min(2)];
            ui.spacing_mut().item_spacing.x = 3.0;
            ui.label(RichText::new(stroke).color(colour));
            ui.label(RichText::new(*name).small());
            ui.add_space(6.0);
        }
    });
}

/// How long the steps of the worlds take, and how well they are solved.
fn readings(ui: &mut Ui, state: &AppState) {
    let mut is_told = false;
    for (index, world) in state.frame.worlds.iter().enumerate() {
        let (ms, residual) = (world.step_ms, world.snapshot.observables.residual);
        if ms > 0.0 && residual > 0.0 {
            let name = super::compare::title(state, index);
            ui.label(format!("{name}: {ms:.3} ms a step, residual {residual:.1e}"));
            is_told = true;
        }
    }
    if !is_told {
        ui.weak("The run shows here from its first step on.");
    }
}

/// Powers of ten between two exponents, every so many that there are seven at the most.
fn decades((low, high): (f64, f64)) -> Vec<GridMark> {
    let (first, last) = (low.ceil() as i64, high.floor() as i64);
    let step = ((last - first).max(0) / 7 + 1) as usize;
    let marks = (first..=last).filter(|exponent| exponent.rem_euclid(step as i64) == 0);
    marks.map(|exponent| GridMark { value: exponent as f64, step_size: step as f64 }).collect()
}

fn power_of_ten(exponent: f64) -> String {
    format!("1e{exponent:.0}")
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
