//! Panel: what the run measures, against simulated time.

use egui::{RichText, Ui};

use crate::app::IN_BROWSER;
use crate::app::export::write_table;
use crate::app::file_names::free_path;
use crate::app::plots::{PlotData, WorldCurve, draw};
use crate::app::state::AppState;
use crate::app::theme;
use crate::live::Command;
use crate::sim::{Observables, QUANTITIES, Quantity};
use crate::study::png::write_png;

pub(crate) fn show(ui: &mut Ui, state: &mut AppState) {
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
        until_secs: state.frame.start.as_ref().map_or(1.0, |start| start.scene.duration_secs),
    }
}

/// True where a quantity is chosen, or where nothing that is chosen says anything of what is open.
fn is_shown(state: &AppState, quantity: &Quantity<Observables>) -> bool {
    let is_chosen = |quantity: &Quantity<Observables>| {
        means_something(state, quantity)
            && state.preferences.quantities.iter().any(|name| name == quantity.name)
    };
    is_chosen(quantity) || (means_something(state, quantity) && !QUANTITIES.iter().any(is_chosen))
}

/// True where a quantity says anything of what is open.
fn means_something(state: &AppState, quantity: &Quantity<Observables>) -> bool {
    quantity.name != "slump" || state.slumps()
}

/// The line above the plots: what folds them, and what other piles say beside the selected world.
pub(crate) fn header(ui: &mut Ui, state: &mut AppState) {
    ui.horizontal(|ui| {
        let text = if state.preferences.plots { "▾ Plot" } else { "▸ Plot" };
        let plots = ui.selectable_label(false, text).on_hover_text("Show or fold the plots");
        state.note_control("Plots", plots.rect);
        state.preferences.plots ^= plots.clicked();
        let hint = state.about_ensemble();
        let said = state.said_of_ensemble(state.selected);
        if let (Some(said), Some(world)) = (said, state.world()) {
            let text = format!("Δy {:.3}; {said}", world.snapshot.observables.slump);
            ui.add(egui::Label::new(text).truncate()).on_hover_text(hint);
        }
    });
}

/// What is plotted, and what saves it.
pub(super) fn choices(ui: &mut Ui, state: &mut AppState) {
    ui.horizontal_wrapped(|ui| {
        ui.label("Plot");
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
    });
    let chosen = &mut state.preferences.chosen_plot;
    if chosen.on {
        ui.horizontal_wrapped(|ui| chosen.choose(ui));
    }
    ui.horizontal(|ui| files(ui, state));
    if state.ensemble.is_possible() {
        let hint = state.about_ensemble();
        let switch = ui.checkbox(&mut state.preferences.ensemble, "Other piles, on idle cores");
        state.note_control("other piles", switch.on_hover_text(&hint).rect);
    }
}

/// What saves the plots, and how they were thinned.
fn files(ui: &mut Ui, state: &mut AppState) {
    let stem = format!("{}-curves", super::see::file_stem(state));
    // A page must not wait for a device that draws.
    if !IN_BROWSER
        && ui.button("Plot as PNG").on_hover_text("Save the plots as a picture.").clicked()
    {
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
    if ui.button("Curves as CSV").on_hover_text(hint).clicked() {
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
        ui.label(RichText::new(format!("plotted: one step in {stride}")).small().weak());
    }
}
