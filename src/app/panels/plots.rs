//! Panel: what the run measures, against simulated time.

use egui::{RichText, Ui};

use crate::app::export::Export;
use crate::app::plot_picture::PlotPicture;
use crate::app::plots::{PlotData, draw};
use crate::app::state::AppState;
use crate::app::theme;
use crate::sim::live::Command;
use crate::sim::{Observables, QUANTITIES, Quantity};

/// Shows the panel.
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
            .map(|(index, world)| {
                let name = super::compare::title(state, index);
                (name, theme::world_colour(index, dark), world.curve.clone())
            })
            .collect(),
        ghosts: super::past::ghost(state).map_or_else(Vec::new, |run| {
            run.worlds.iter().map(|world| world.curve.clone()).collect()
        }),
        quantities: QUANTITIES.iter().filter(|quantity| is_shown(state, quantity)).collect(),
        now_secs: state.frame.time_secs(),
        // An empty plot is as wide as a short run; a long one is seen as a whole.
        until_secs: 0.2 * state.frame.start.as_ref().map_or(1.0, |start| start.duration_secs),
    }
}

fn is_shown(state: &AppState, quantity: &Quantity<Observables>) -> bool {
    state.preferences.quantities.iter().any(|name| name == quantity.name)
}

fn header(ui: &mut Ui, state: &mut AppState) {
    ui.horizontal(|ui| {
        ui.label(RichText::new("Plots").heading());
        for quantity in QUANTITIES {
            let mut shown = is_shown(state, quantity);
            if ui.toggle_value(&mut shown, quantity.name).changed() {
                let chosen = &mut state.preferences.quantities;
                chosen.retain(|name| name != quantity.name);
                chosen.extend(shown.then(|| quantity.name.to_owned()));
            }
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let stem = format!("{}-curves", super::scene::file_stem(state));
            let folder = state.preferences.folder.clone();
            if ui.button("PNG").on_hover_text("Save the plots as a picture.").clicked() {
                let data = data(ui, state);
                let size = state.preferences.picture_size;
                let picture = PlotPicture { data, size, dark: ui.visuals().dark_mode };
                let export = Export::Plots(Box::new(picture));
                state.exporter.submit(ui.ctx(), export, &folder, &stem);
            }
            if ui.button("CSV").on_hover_text("Save all observables of all worlds.").clicked() {
                let curves = state.frame.worlds.iter().map(|world| world.curve.clone()).collect();
                state.exporter.submit(ui.ctx(), Export::Curves(curves), &folder, &stem);
            }
            if state.frame.worlds.iter().any(|world| world.curve.stride() > 1) {
                let stride = state.frame.worlds.iter().map(|world| world.curve.stride()).max();
                let text = format!("every {}th step", stride.unwrap_or(1));
                ui.label(RichText::new(text).small().weak());
            }
        });
    });
}
