//! The status bar: how fast, whether to trust it, what went wrong, and the ways to everything else.

use egui::{Align, Label, Layout, Rect, RichText, Ui};

use super::trust;
use crate::app::budget::FAST;
use crate::app::page::Page;
use crate::app::state::AppState;
use crate::app::theme;
use crate::live::{WorldAlarm, WorldFrame};
use crate::sim::{AlarmKind, Settings};

/// Shows the bar.
pub(crate) fn show(ui: &mut Ui, state: &mut AppState) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 10.0;
        trust::button(ui, state);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ways(ui, state);
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                pace(ui, state);
                messages(ui, state);
            });
        });
    });
}

/// The ways to the pages and to the keys, from the right.
fn ways(ui: &mut Ui, state: &mut AppState) {
    ui.toggle_value(&mut state.shown.help, "Help").on_hover_text("All keys (H)");
    let page = state.preferences.page;
    let save = ui.selectable_label(page == Some(Page::Save), "Save…");
    state.note_control("save", save.rect);
    let hint = "Pictures, films, data, sessions, links";
    if save.on_hover_text(hint).clicked() {
        let is_open = page == Some(Page::Save);
        state.preferences.page = (!is_open).then_some(Page::Save);
    }
    let is_open = page.is_some_and(|page| page != Page::Save);
    let text = if is_open { "More ▴" } else { "More ▾" };
    let more = ui.selectable_label(is_open, text);
    state.note_control("more", more.rect);
    let hint = "Scenes, laws and solvers, comparisons, the look";
    if more.on_hover_text(hint).clicked() {
        state.preferences.page = (!is_open).then_some(Page::Pile);
    }
}

/// How fast time passes, while it does.
fn pace(ui: &mut Ui, state: &AppState) {
    let frame = &state.frame;
    if frame.seeking {
        ui.label(RichText::new("computing that moment").weak());
    } else if frame.stored && frame.playing {
        ui.label(RichText::new("stored").weak())
            .on_hover_text("What is recorded is shown as it was; nothing is computed.");
    } else if frame.playing && frame.steps_per_sec > 0.0 {
        let text = format!("{:.0} steps/s, {:.2}×", frame.steps_per_sec, frame.real_time_factor);
        ui.label(RichText::new(text).weak())
            .on_hover_text("Steps of all worlds together, and simulated time per time on the wall");
    }
}

/// What was just done, or what went wrong. In a lesson that shows what goes wrong, nothing does.
fn messages(ui: &mut Ui, state: &mut AppState) {
    if let Some((notice, left)) = state.notice() {
        let (text, colour) = (notice.text.clone(), notice.colour(ui));
        ui.ctx().request_repaint_after_secs(left);
        message(ui, &text, colour);
        return;
    }
    let warning = theme::warning(ui.visuals().dark_mode);
    if let Some(failure) = state.frame.worlds.iter().find_map(|world| world.failure.clone()) {
        message(ui, &format!("{failure}. Drag the timeline back, or start again."), warning);
    } else if let Some(alarm) = alarms(state).into_iter().next().filter(|_| !state.touring) {
        let rect = message(ui, &format!("▲ {alarm}"), warning);
        state.note_control("alarm", rect);
    }
}

/// Shows a line in the room that is left, and all of it to whoever points at it.
fn message(ui: &mut Ui, text: &str, colour: egui::Color32) -> Rect {
    // A label that is cut shows the whole by itself.
    ui.add(Label::new(RichText::new(text).color(colour)).truncate()).rect
}

/// The alarms of the selected world, then those of others with their titles; in each, those of the present settings
/// before earlier ones, the newest first.
pub(super) fn alarms(state: &AppState) -> Vec<String> {
    let of_world = |index: usize| {
        let world = &state.frame.worlds[index];
        let is_news = |alarm: &&WorldAlarm| !is_asked_for(alarm, world);
        let mut alarms: Vec<&WorldAlarm> = world.alarms.iter().rev().filter(is_news).collect();
        alarms.sort_by_key(|alarm| alarm.is_earlier);
        let said = move |alarm: &WorldAlarm| match state.compares() {
            true => format!("{}: {}", super::compare::title(state, index), alarm.text),
            false => alarm.text.to_string(),
        };
        alarms.into_iter().map(said).collect::<Vec<_>>()
    };
    let others = (0..state.frame.worlds.len()).filter(|&index| index != state.selected);
    let selected = (!state.frame.worlds.is_empty()).then_some(state.selected);
    selected.into_iter().chain(others).flat_map(of_world).collect()
}

/// True where an alarm says what was chosen with open eyes: so many sweeps a step, solved or not, of a pile without cohesion.
/// With cohesion such steps break bonds, and it is told.
fn is_asked_for(alarm: &WorldAlarm, world: &WorldFrame) -> bool {
    let fast = FAST.among(&world.snapshot.surroundings);
    let Settings { parameters, solver, .. } = world.controls.settings;
    alarm.kind == AlarmKind::SweepLimit && solver == fast && parameters.bond == 0.0
}
