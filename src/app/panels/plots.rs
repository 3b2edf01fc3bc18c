//! Panel: what the run measures, against simulated time.

use egui::{RichText, Ui};

use crate::app::export::{free_path, write_table};
use crate::app::plots::{PlotData, WorldCurve, draw};
use crate::app::state::AppState;
use crate::app::theme;
use crate::live::Command;
use crate::sim::{Observables, QUANTITIES, Quantity};
use crate::study::png::write_png;

pub(crate) fn show(ui: &mut Ui, state: &mut AppState) {
    header(ui, state);
    let data = data(ui, state);
    if let Some(time_secs) = draw(ui, &data) {
        state.live.send(Command::Seek(time_secs.clamp(0.0, state.frame.recorded_secs())));
    }
}

fn data(ui: &Ui, state: &AppState) -> PlotData {
    let dark = ui.visuals().dark_mode;
    let worlds = state.frame.worlds.iter().enumerate();
    PlotData {
        worlds: worlds
            .map(|(index, world)| WorldCurve {
                name: super::compare::title(state, index),
                colour: theme::world_colour(index, dark),
                curve: world.curve.clone(),
                others: state.ensemble.summary(index).map(|summary| summary.band),
            })
            .collect(),
        ghosts: super::run::ghost(state).map_or_else(Vec::new, |run| {
            run.worlds.iter().map(|world| world.curve.clone()).collect()
        }),
        quantities: QUANTITIES.iter().filter(|quantity| is_shown(state, quantity)).collect(),
        chosen: state.preferences.chosen_plot.clone(),
        now_secs: state.frame.time_secs(),
        // An empty plot is as wide as a short run; a long one is seen as a whole.
        until_secs: 0.2 * state.frame.start.as_ref().map_or(1.0, |start| start.duration_secs),
    }
}

fn is_shown(state: &AppState, quantity: &Quantity<Observables>) -> bool {
    means_something(state, quantity)
        && state.preferences.quantities.iter().any(|name| name == quantity.name)
}

/// True where a quantity says anything of what is open.
fn means_something(state: &AppState, quantity: &Quantity<Observables>) -> bool {
    quantity.name != "slump" || state.slumps()
}

/// Points that a head in one row takes.
const WIDE_HEAD: f32 = 480.0;

fn header(ui: &mut Ui, state: &mut AppState) {
    let is_narrow = ui.available_width() < WIDE_HEAD;
    ui.horizontal(|ui| {
        ui.label(RichText::new("Plots").heading());
        if !is_narrow {
            switches(ui, state);
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| files(ui, state));
    });
    if is_narrow {
        ui.horizontal_wrapped(|ui| switches(ui, state));
    }
    let chosen = &mut state.preferences.chosen_plot;
    if chosen.on {
        ui.horizontal(|ui| chosen.choose(ui));
    }
}

/// What is drawn.
fn switches(ui: &mut Ui, state: &mut AppState) {
    for quantity in QUANTITIES {
        if !means_something(state, quantity) {
            continue;
        }
        let mut shown = is_shown(state, quantity);
        if ui.toggle_value(&mut shown, quantity.name).changed() {
            let chosen = &mut state.preferences.quantities;
            chosen.retain(|name| name != quantity.name);
            chosen.extend(shown.then(|| quantity.name.to_owned()));
        }
    }
    ui.toggle_value(&mut state.preferences.chosen_plot.on, "y over x")
        .on_hover_text("Any quantity that steps measure against any other.");
}

/// From the right: what saves the plots, how they were thinned, and in the room that is left the other piles.
fn files(ui: &mut Ui, state: &mut AppState) {
    let stem = format!("{}-curves", super::see::file_stem(state));
    if ui.button("PNG").on_hover_text("Save the plots as a picture.").clicked() {
        let data = data(ui, state);
        let size = state.preferences.picture_size;
        let (dark, texts) = (ui.visuals().dark_mode, state.texts(false));
        let stem = stem.clone();
        state.export(ui.ctx(), move |folder, printers| {
            let path = free_path(folder, &stem, "png");
            write_png(&path, &printers.canvas()?.print(&data, size, dark)?, &texts)?;
            Ok(path)
        });
    }
    let hint = "Save all observables of all worlds; a text beside the table says what they are of.";
    if ui.button("CSV").on_hover_text(hint).clicked() {
        let worlds = state.frame.worlds.iter();
        let curves: Vec<_> = worlds.map(|world| world.curve.clone()).collect();
        let texts = state.texts(false);
        state.export(ui.ctx(), move |folder, _| {
            let path = free_path(folder, &stem, "csv");
            write_table(&path, &curves, &texts)?;
            Ok(path)
        });
    }
    let strides = state.frame.worlds.iter().map(|world| world.curve.stride());
    if let Some(stride) = strides.max().filter(|&stride| stride > 1) {
        ui.label(RichText::new(format!("one step in {stride}")).small().weak());
    }
    ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| others(ui, state));
}

/// The switch of the other piles, and what they say beside the selected world.
fn others(ui: &mut Ui, state: &mut AppState) {
    if !state.ensemble.is_possible() {
        return;
    }
    ui.separator();
    let hint = state.about_ensemble();
    let switch = ui.toggle_value(&mut state.preferences.ensemble, "other piles");
    state.note_control("other piles", switch.on_hover_text(&hint).rect);
    let said = state.said_of_ensemble(state.selected);
    if let (Some(said), Some(world)) = (said, state.world()) {
        let text = format!("Δy {:.3}; {said}", world.snapshot.observables.slump);
        ui.add(egui::Label::new(text).truncate()).on_hover_text(hint);
    }
}
