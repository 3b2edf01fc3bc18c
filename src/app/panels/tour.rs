//! The strip above everything while the tour goes on: what to watch, and the way on.

use egui::{Align, Button, Layout, RichText, Ui};

use crate::app::state::AppState;
use crate::app::theme;
use crate::app::tour::{STATIONS, Station};

/// Shows the strip.
pub(crate) fn show(ui: &mut Ui, state: &mut AppState) {
    let at = state.preferences.tour.at;
    let Some(Station { title, watch, .. }) = STATIONS.get(at) else { return };
    ui.horizontal(|ui| {
        let dark = ui.visuals().dark_mode;
        let accent = theme::accent(dark);
        let count = format!("{} of {}", at + 1, STATIONS.len());
        ui.label(RichText::new(count).color(accent));
        ui.label(RichText::new(*title).heading());
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let leave = ui.button("Leave").on_hover_text(
                "End the tour; the worlds stay. It goes on here when it is taken up again.",
            );
            state.note_control("leave tour", leave.rect);
            if leave.clicked() {
                state.leave_tour();
                return;
            }
            let last = at + 1 == STATIONS.len();
            let next =
                Button::new(RichText::new("Next ▶").color(theme::on_accent(dark))).fill(accent);
            let next = ui.add_enabled(!last, next).on_hover_text("The next station");
            state.note_control("next station", next.rect);
            if next.clicked() {
                state.visit(at + 1);
            }
            let back = ui.add_enabled(at > 0, Button::new("◀ Back"));
            if back.on_hover_text("The station before").clicked() {
                state.visit(at.saturating_sub(1));
            }
            let again = ui.button("Again").on_hover_text("This station as it was at first");
            if again.clicked() {
                state.visit(at);
            }
        });
    });
    ui.label(*watch);
}

/// The way back to the tour.
pub(crate) fn resume_button(ui: &mut Ui, state: &mut AppState) {
    let at = state.preferences.tour.at.min(STATIONS.len() - 1);
    let text = format!("Tour: {} of {}", at + 1, STATIONS.len());
    let button = ui.button(RichText::new(text).small());
    let response = button.on_hover_text(format!("Take up the tour: {}", STATIONS[at].title));
    state.note_control("tour", response.rect);
    if response.clicked() {
        state.visit(at);
    }
}
