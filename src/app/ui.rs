//! The layout of the window, as a function of the state alone.

use egui::{CentralPanel, CollapsingHeader, Frame, Margin, Panel, RichText, ScrollArea, Ui};

use super::fill::fill;
use super::panels::{SECTIONS, Section, help, plots, scene, status, tour, transport};
use super::state::AppState;
use super::{drop, hint, keys};
use crate::config::Config;

/// Width of the sidebar, points.
const SIDEBAR: f32 = 296.0;
/// Height of the plots, points.
const PLOTS: f32 = 176.0;

/// The whole window.
pub fn ui(ui: &mut Ui, state: &mut AppState) {
    state.refresh();
    let context = ui.ctx().clone();
    state.restore_layout(&context);
    state.follow_link(&context);
    if context.options(|options| options.theme_preference) != state.preferences.theme {
        context.set_theme(state.preferences.theme);
    }
    state.follow_other_piles(&context);
    drop::take_files(&context, state);
    keys::act(&context, state);

    fill(ui, ui.max_rect(), ui.visuals().panel_fill);
    let tight = Frame::new().inner_margin(Margin::symmetric(8, 4));
    Panel::bottom("status").frame(tight).resizable(false).show(ui, |ui| status::show(ui, state));
    if state.touring {
        Panel::top("tour").frame(tight).resizable(false).show(ui, |ui| tour::show(ui, state));
    }
    let mut sidebar = state.preferences.sidebar;
    Panel::left("sidebar")
        .frame(Frame::new().inner_margin(Margin { left: 10, right: 4, top: 8, bottom: 4 }))
        .default_size(SIDEBAR)
        .size_range(SIDEBAR - 26.0..=460.0)
        .show_collapsible(ui, &mut sidebar, |ui| {
            ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
                // The scroll bar floats over the right edge.
                Frame::new().inner_margin(Margin { right: 8, ..Margin::ZERO }).show(ui, |ui| {
                    sidebar_contents(ui, state);
                });
            });
        });
    state.preferences.sidebar = sidebar;
    let mut shown = state.preferences.plots;
    Panel::bottom("plots")
        .frame(tight)
        .resizable(true)
        .default_size(PLOTS)
        .size_range(120.0..=600.0)
        .show_collapsible(ui, &mut shown, |ui| plots::show(ui, state));
    state.preferences.plots = shown;
    Panel::bottom("timeline").frame(tight).resizable(false).show(ui, |ui| {
        transport::timeline(ui, state);
    });
    CentralPanel::no_frame().show(ui, |ui| {
        scene::show(ui, state);
        waiting(ui, state);
    });
    help::show(ui, state);
}

fn sidebar_contents(ui: &mut Ui, state: &mut AppState) {
    transport::release_button(ui, state);
    if !state.touring {
        // Other scenes say under their name what there is to watch.
        let is_pile = state.frame.start.as_ref().is_some_and(|it| it.name == Config::DEFAULT_SCENE);
        let world = state.world().filter(|_| is_pile);
        if let Some(hint) = world.map(|world| hint::what_to_try(&world.controls.settings)) {
            ui.label(RichText::new(hint).small().weak());
        }
        tour::resume_button(ui, state);
    }
    let asked = state.opened_panel.take();
    ui.add_space(2.0);
    for Section { id, title, open, show } in SECTIONS {
        let Some(title) = title(state) else { continue };
        ui.separator();
        let shown = CollapsingHeader::new(RichText::new(title).heading())
            .id_salt(id)
            .default_open(*open)
            .open((asked == Some(*id)).then_some(true))
            .show_unindented(ui, |ui| show(ui, state));
        state.note_control(id, shown.header_response.rect);
    }
}

/// What the middle says while there is nothing to see yet.
fn waiting(ui: &mut Ui, state: &AppState) {
    let Some(progress) = &state.frame.loading else { return };
    egui::Area::new(egui::Id::unique("loading"))
        .anchor(egui::Align2::CENTER_TOP, [0.0, 40.0])
        .interactable(false)
        .show(ui.ctx(), |ui| {
            Frame::popup(ui.style()).show(ui, |ui| {
                ui.horizontal(|ui| {
                    ui.spinner();
                    let text = if progress.text.is_empty() { "Loading" } else { &progress.text };
                    ui.label(text);
                });
            });
        });
}
