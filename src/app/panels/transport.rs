//! The run's controls: release, play, pause, step, reset, and the timeline.

use egui::{Button, RichText, Slider, Ui};

use crate::app::state::AppState;
use crate::app::theme;
use crate::live::Command;

/// The one button that nobody can miss.
pub(crate) fn release_button(ui: &mut Ui, state: &mut AppState) {
    let frame = &state.frame;
    let failed = frame.worlds.iter().any(|world| world.failure.is_some());
    let (text, hint) = if frame.playing {
        ("❚❚  Pause", "Stop time (space)")
    } else if frame.held() && !frame.replaying {
        ("▶  Release the walls", "At t = 0 the walls go, and the pile holds or slumps (space)")
    } else if frame.branching {
        ("▶  Go on from here", "With what was changed; the run so far is kept under Run (space)")
    } else if frame.replaying {
        ("▶  Replay", "Show the record from this moment on; at its end, compute on (space)")
    } else if frame.at_start() {
        ("▶  Start", "Let time pass (space)")
    } else {
        ("▶  Play on", "Let time pass again, from the moment that is shown (space)")
    };
    let dark = ui.visuals().dark_mode;
    let (fill, ink) = match frame.playing {
        true => (ui.visuals().widgets.inactive.weak_bg_fill, ui.visuals().text_color()),
        false => (theme::accent(dark), theme::on_accent(dark)),
    };
    let text = RichText::new(text).size(16.0).color(ink).family(theme::bold());
    let button = Button::new(text).fill(fill).min_size(egui::vec2(ui.available_width(), 38.0));
    let ready = !frame.worlds.is_empty() && !failed && frame.loading.is_none();
    let response = ui.add_enabled(ready, button).on_hover_text(hint);
    if response.clicked() {
        state.toggle_play();
    }
    state.note_control("release", response.rect);
}

/// The row below the scene.
pub(crate) fn timeline(ui: &mut Ui, state: &mut AppState) {
    let ready = !state.frame.worlds.is_empty() && state.frame.loading.is_none();
    ui.add_enabled_ui(ready, |ui| {
        ui.horizontal(|ui| {
            let mut button = |icon: &str, name: &str, hint: &str| {
                let button = Button::new(RichText::new(icon).size(12.0));
                let response = ui.add(button.min_size(egui::vec2(28.0, 22.0)));
                response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, name));
                response.on_hover_text(format!("{name}: {hint}")).clicked()
            };
            if button("|◀", "Reset", "back to the start, with the present settings (R)") {
                state.live.send(Command::Reset);
            }
            if button("◀", "Step back", "one step back in the recording (←)") {
                state.step_back();
            }
            let (icon, name, hint) = match state.frame.playing {
                true => ("❚❚", "Pause", "stop time (space)"),
                false => ("▶", "Play", "let time pass (space)"),
            };
            if button(icon, name, hint) {
                state.toggle_play();
            }
            if button("▶|", "Step", "take one step and pause (→)") {
                state.step();
            }
            scrub(ui, state);
        });
    });
}

fn scrub(ui: &mut Ui, state: &mut AppState) {
    let end = state.frame.recorded_secs();
    let now = state.frame.time_secs();
    let duration = state.frame.start.as_ref().map_or(1.0, |start| start.duration_secs);
    let label = format!("{now:.4} / {end:.4} s");
    let from_the_right = egui::Layout::right_to_left(egui::Align::Center);
    ui.with_layout(from_the_right, |ui| {
        ui.allocate_ui_with_layout(egui::vec2(132.0, 20.0), from_the_right, |ui| {
            ui.label(RichText::new(label).monospace());
        });
        let mut at = now;
        ui.spacing_mut().slider_width = (ui.available_width() - 8.0).max(40.0);
        let slider = Slider::new(&mut at, 0.0..=end.max(1e-3 * duration)).show_value(false);
        let response = ui.add_enabled(end > 0.0, slider);
        response.widget_info(|| egui::WidgetInfo::slider(end > 0.0, now, "Timeline"));
        if response.changed() {
            state.live.send(Command::Seek(at.min(end)));
        }
        state.note_control("timeline", response.rect);
        response.on_hover_text("The recorded run: drag to any moment, then play on from there");
    });
}
