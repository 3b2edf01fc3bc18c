//! Panel: plots of measured quantities of the run against simulated time.

use egui::{Color32, RichText, Ui};

use crate::app::IN_BROWSER;
use crate::app::context::{PanelContext, Request};
use crate::app::experiment_plot::has_quantity;
use crate::app::exports::write_table;
use crate::app::glossary::explained;
use crate::app::plots::{LEAST_WIDTH, PlotData, WorldCurve, draw, draw_with_key};
use crate::app::preferences::Preferences;
use crate::app::theme;
use crate::app::time_step_figure::{TimeStepFigure, without_time_step};
use crate::app::titles::title_against;
use crate::app::watched_run::WatchedRun;
use crate::app::work::MaySend;
use crate::live::Command;
use crate::number::millis_text;
use crate::output::write_file;
use crate::sim::{Observables, QUANTITIES, Quantity, Settings};
use crate::study::png::write_png;

/// Fraction of the panel's width for the plot of slump against Δt; the other plots have the rest.
const FIGURE_PART: f32 = 0.4;

pub(super) fn show(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let width = ui.available_width();
    if has_quantity(&context.run.frame) {
        return ui.columns(2, |columns| {
            context.experiment.draw(&mut columns[0], &context.run.frame);
            curves(&mut columns[1], context);
        });
    }
    let Some(figure) = figure(ui, context).filter(|_| width > 4.0 * LEAST_WIDTH) else {
        return curves(ui, context);
    };
    let height = ui.available_height();
    ui.horizontal(|ui| {
        let left = egui::vec2((1.0 - FIGURE_PART) * width, height);
        ui.allocate_ui(left, |ui| ui.vertical(|ui| curves(ui, context)));
        ui.vertical(|ui| figure.draw(ui, |ui| figure_buttons(ui, context, &figure)));
    });
}

/// Returns the plot of slump against Δt; `None` if slump is not plotted or no result exists. In a lesson the plot shows
/// only results with the settings of the lesson (with any Δt).
fn figure(ui: &Ui, context: &PanelContext<'_>) -> Option<TimeStepFigure> {
    let mut shown = QUANTITIES.iter().filter(|it| is_shown(context.run, context.preferences, it));
    let slump_is_shown = shown.any(|quantity| quantity.name == "slump");
    let worlds = context.run.frame.worlds.iter();
    let worlds: Vec<_> = worlds.map(|world| world.controls.settings).collect();
    let is_of_lesson = |settings: &Settings| {
        let is_like = |world| without_time_step(world) == without_time_step(settings);
        !context.touring || worlds.iter().any(is_like)
    };
    let released = context.ensemble.released(&context.run.frame);
    let released = released.filter(|(settings, _)| is_of_lesson(settings));
    TimeStepFigure::new(released, &worlds, ui.visuals().dark_mode).filter(|_| slump_is_shown)
}

/// Shows the buttons that save or clear the plot of slump against Δt, from right to left.
fn figure_buttons(ui: &mut Ui, context: &mut PanelContext<'_>, figure: &TimeStepFigure) {
    let hint = "Remove the points, except those of the visible piles.";
    let clear = ui.small_button("Clear").on_hover_text(hint);
    context.note_control("clear figure", clear.rect);
    if clear.clicked() {
        context.ask(Request::ForgetReleased);
    }
    let stem = format!("{}-slump-over-dt", context.run.file_stem());
    if ui.small_button("CSV").on_hover_text("Save the points as a table.").clicked() {
        let table = figure.table();
        context.write(ui.ctx(), stem.clone(), "csv", move |path, _| {
            write_file(path, table.as_bytes())
        });
    }
    // Waiting for a graphics device would block the browser version.
    if !IN_BROWSER && ui.small_button("PNG").on_hover_text("Save this plot as a picture.").clicked()
    {
        let figure = figure.clone();
        print(ui, context, stem, move |ui| figure.draw(ui, |_| {}));
    }
}

/// Saves a picture of plots, which `draw` draws, in the size that the preferences state.
fn print(
    ui: &Ui,
    context: &mut PanelContext<'_>,
    stem: String,
    draw: impl Fn(&mut Ui) + MaySend + 'static,
) {
    let (size, dark) = (context.preferences.picture_size, ui.visuals().dark_mode);
    let texts = context.run.texts(false);
    context.write(ui.ctx(), stem, "png", move |path, printers| {
        write_png(path, &printers.canvas()?.print(size, dark, draw)?, &texts)
    });
}

fn curves(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let data = data(ui, context);
    if let Some(time_secs) = draw(ui, &data) {
        context
            .run
            .live
            .send(Command::Seek(time_secs.clamp(0.0, context.run.frame.recorded_secs())));
    }
}

fn data(ui: &Ui, context: &PanelContext<'_>) -> PlotData {
    let dark = ui.visuals().dark_mode;
    let worlds = context.run.frame.worlds.iter().enumerate();
    PlotData {
        worlds: worlds
            .map(|(index, world)| WorldCurve {
                name: context.run.title(index),
                colour: theme::world_colour(index, dark),
                curve: world.curve.clone(),
                others: context.ensemble.summary(index).map(|summary| summary.band),
            })
            .collect(),
        ghosts: ghosts(context),
        quantities: QUANTITIES
            .iter()
            .filter(|quantity| is_shown(context.run, context.preferences, quantity))
            .collect(),
        now_secs: context.run.frame.time_secs(),
        until_secs: context.run.duration_secs(),
    }
}

/// Returns the curves of the earlier run that is compared with the present run, one entry per simulation.
fn ghosts(context: &PanelContext<'_>) -> Vec<WorldCurve> {
    let has_others = context.ensemble.is_possible();
    let worlds = context.ghost().map_or(&[][..], |run| &run.worlds).iter();
    let pairs = worlds.zip(&context.run.frame.worlds).map(|(before, now)| {
        let (settings, now) = (&before.controls.settings, &now.controls.settings);
        WorldCurve {
            name: format!("earlier run: {}", title_against(settings, now)),
            colour: Color32::from_gray(128).gamma_multiply(0.6),
            curve: before.curve.clone(),
            others: context
                .ensemble
                .band(settings)
                .filter(|_| has_others && settings != now)
                .cloned(),
        }
    });
    pairs.collect()
}

/// True if a quantity is plotted: if the user chose it and it is meaningful in this scene. Without such a choice, all
/// meaningful quantities are plotted. A scene with the plot of an experiment's main quantity has space for only one
/// more plot, so then only the energy is plotted.
fn is_shown(run: &WatchedRun, preferences: &Preferences, quantity: &Quantity<Observables>) -> bool {
    let is_chosen = |quantity: &Quantity<Observables>| {
        means_something(run, quantity)
            && preferences.quantities.iter().any(|name| name == quantity.name)
    };
    // If an experiment has a main quantity, there is space for only one more plot.
    let is_default = match has_quantity(&run.frame) {
        true => quantity.name == "energy",
        false => means_something(run, quantity),
    };
    is_chosen(quantity) || (is_default && !QUANTITIES.iter().any(is_chosen))
}

/// True if a quantity is meaningful in this scene. Slump is meaningful only for heaps.
fn means_something(run: &WatchedRun, quantity: &Quantity<Observables>) -> bool {
    quantity.name != "slump" || run.slumps()
}

/// Shows the line above the plots: the button that shows or hides the plots, then the slump of the pile and the mean
/// slump of runs from other initial states, or a sentence that compares these means before and after a change of
/// settings.
pub(super) fn header(ui: &mut Ui, context: &mut PanelContext<'_>) {
    ui.horizontal(|ui| {
        let text = if context.preferences.plots { "▾ Plot" } else { "▸ Plot" };
        let plots = ui.selectable_label(false, text).on_hover_text("Show or hide the plots");
        context.note_control("Plots", plots.rect);
        context.preferences.plots ^= plots.clicked();
        let hint = context.ensemble.about(context.run.selected);
        let said = context.ensemble.said(&context.run.frame, context.run.selected);
        let own = context.run.slump_text(context.run.selected);
        let said = match IN_BROWSER {
            true => (!own.is_empty()).then(|| "no other piles run in a browser".to_owned()),
            false => said,
        };
        let text = effect(context).or_else(|| Some(format!("{own}; {}", said?)));
        if let Some(text) = text {
            let label = ui.add(egui::Label::new(&text).truncate()).on_hover_text(hint);
            explained(label, &text);
        }
    });
}

/// Returns a sentence that compares the mean slumps of runs from other initial states, at the displayed simulated time,
/// under the settings of the earlier run and under the settings of the present run. `None` in the initial state,
/// without an earlier run for comparison, if no settings changed, or if results are missing.
fn effect(context: &PanelContext<'_>) -> Option<String> {
    let frame = &context.run.frame;
    let mut worlds = context.ghost()?.worlds.iter().zip(&frame.worlds);
    let (before, now) =
        worlds.find(|(before, now)| before.controls.settings != now.controls.settings)?;
    let (before, now) = (&before.controls.settings, &now.controls.settings);
    context.ensemble.effect(before, now, frame.time_secs()).filter(|_| !frame.at_start())
}

/// Shows the buttons that choose the plotted quantities and the buttons that save plots.
pub(super) fn choices(ui: &mut Ui, context: &mut PanelContext<'_>) {
    ui.horizontal_wrapped(|ui| {
        ui.label("Plot");
        for quantity in QUANTITIES {
            if !means_something(context.run, quantity) {
                continue;
            }
            let mut shown = is_shown(context.run, context.preferences, quantity);
            if ui.toggle_value(&mut shown, quantity.name).changed() {
                let chosen = &mut context.preferences.quantities;
                chosen.retain(|name| name != quantity.name);
                chosen.extend(shown.then(|| quantity.name.to_owned()));
            }
        }
    });
    ui.horizontal(|ui| files(ui, context));
    if context.ensemble.is_possible() {
        let hint = context.ensemble.about(context.run.selected);
        let switch = ui.checkbox(&mut context.preferences.ensemble, "Other piles, on idle cores");
        context.note_control("other piles", switch.on_hover_text(&hint).rect);
    }
    if IN_BROWSER {
        let text = "In a browser one thread computes, so no other piles run, and plots are saved only as CSV.";
        ui.label(RichText::new(text).small().weak());
    }
}

/// Shows the buttons that save the plots as a picture and the curves as a table. If the curves omit steps, shows the
/// simulated time between two plotted steps.
fn files(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let stem = format!("{}-curves", context.run.file_stem());
    // Waiting for a graphics device would block the browser version.
    if !IN_BROWSER
        && ui.button("Plot as PNG").on_hover_text("Save the plots as a picture.").clicked()
    {
        let data = data(ui, context);
        print(ui, context, stem.clone(), move |ui| draw_with_key(ui, &data));
    }
    let hint =
        "Save all observables of all worlds. A text file next to the table describes the run.";
    if ui.button("Curves as CSV").on_hover_text(hint).clicked() {
        let worlds = context.run.frame.worlds.iter();
        let curves: Vec<_> = worlds.map(|world| world.curve.clone()).collect();
        let texts = context.run.texts(false);
        context.write(ui.ctx(), stem, "csv", move |path, _| write_table(path, &curves, &texts));
    }
    let worlds = context.run.frame.worlds.iter();
    let spacing_secs = worlds.map(|world| world.curve.least_spacing_secs()).fold(0.0, f64::max);
    if spacing_secs > 0.0 {
        let text = format!("plotted: one step every {}", millis_text(spacing_secs));
        ui.label(RichText::new(text).small().weak());
    }
}
