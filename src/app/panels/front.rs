//! The front: release, again, the pace, the timeline, and the four sliders that everything is about.

use egui::{Button, ComboBox, RichText, Slider, Ui};

use super::grain::compact;
use super::physics::shown_settings;
use crate::app::state::AppState;
use crate::app::{budget, setting_control, theme};
use crate::live::Command;
use crate::sim::Settings;

/// Paces that are offered, simulated time per time on the wall.
const PACES: [f64; 7] = [0.01, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0];

/// The settings whose sliders are always in view.
pub const FRONT_SETTINGS: [&str; 4] = ["bond", "dt", "rho", "mu"];
/// Least width of a slider with its number, points.
const LEAST_WIDTH: f32 = 150.0;

pub(crate) fn show(ui: &mut Ui, state: &mut AppState) {
    let ready = !state.frame.worlds.is_empty() && state.frame.loading.is_none();
    ui.add_enabled_ui(ready, |ui| {
        ui.horizontal(|ui| {
            release_button(ui, state);
            let hint = "Back to the start, with the present settings (R)";
            let again = ui.add(Button::new("⟲ Again").min_size(egui::vec2(0.0, 30.0)));
            if again.on_hover_text(hint).clicked() {
                state.live.send(Command::Reset);
            }
            pace(ui, state);
            timeline(ui, state);
        });
        ui.add_space(2.0);
        sliders(ui, state);
        ui.horizontal(|ui| {
            let hint = "On: when a slider is let go, the pile starts again with its new value, and the run before stays as a \
                        ghost. Off: the new value acts from the next step on.";
            let name = "start again when I move a slider";
            let switch = ui.checkbox(&mut state.preferences.starts_again, name);
            state.note_control("start again", switch.on_hover_text(hint).rect);
            what_to_try(ui, state);
        });
    });
}

/// The one button that nobody can miss.
fn release_button(ui: &mut Ui, state: &mut AppState) {
    let frame = &state.frame;
    let failed = frame.worlds.iter().any(|world| world.failure.is_some());
    let (text, hint) = if frame.playing {
        ("❚❚  Pause", "Stop time (space)")
    } else if frame.held() && !frame.replaying {
        ("▶  Release", "At t = 0 the walls go, and the pile holds or slumps (space)")
    } else if frame.branching {
        ("▶  Go on", "With what was changed; the run so far is kept under Compare (space)")
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
    let text = RichText::new(text).size(15.0).color(ink).family(theme::bold());
    let button = Button::new(text).fill(fill).min_size(egui::vec2(126.0, 30.0));
    let response = ui.add_enabled(!failed, button).on_hover_text(hint);
    if response.clicked() {
        state.toggle_play();
    }
    state.note_control("release", response.rect);
}

/// How fast time passes.
fn pace(ui: &mut Ui, state: &mut AppState) {
    let preferences = &mut state.preferences;
    let before = preferences.pace();
    let said = |pace: f64| format!("{pace}×");
    let text = if preferences.full_speed { "max".to_owned() } else { said(preferences.speed) };
    let list = ComboBox::from_id_salt("pace").width(64.0).selected_text(text);
    let shown = list.show_ui(ui, |ui| {
        for pace in PACES {
            let is_chosen = !preferences.full_speed && preferences.speed == pace;
            if ui.selectable_label(is_chosen, said(pace)).clicked() {
                (preferences.speed, preferences.full_speed) = (pace, false);
            }
        }
        let max = ui.selectable_label(preferences.full_speed, "max");
        preferences.full_speed |= max.on_hover_text("As fast as the machine computes.").clicked();
    });
    let response = shown.response;
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, "Pace"));
    state.note_control("pace", response.rect);
    response.on_hover_text("Simulated time per time on the wall ([ slower, ] faster)");
    let pace = state.preferences.pace();
    if pace != before {
        state.live.send(Command::SetPace(pace));
    }
}

/// The next slower or faster pace; nothing is faster than all that the machine can.
pub(crate) fn change_pace(state: &mut AppState, is_faster: bool) {
    let now = state.preferences.speed;
    let mut paces = PACES.into_iter();
    let next = if is_faster {
        paces.find(|&pace| pace > now)
    } else {
        paces.rev().find(|&pace| pace < now)
    };
    state.preferences.full_speed = is_faster && next.is_none();
    state.preferences.speed = next.unwrap_or(now);
    state.live.send(Command::SetPace(state.preferences.pace()));
}

fn timeline(ui: &mut Ui, state: &mut AppState) {
    let end = state.frame.recorded_secs();
    let now = state.frame.time_secs();
    let duration = state.frame.start.as_ref().map_or(1.0, |start| start.scene.duration_secs);
    let label = format!("{} / {} s", compact(now), compact(end));
    let from_the_right = egui::Layout::right_to_left(egui::Align::Center);
    ui.with_layout(from_the_right, |ui| {
        ui.allocate_ui_with_layout(egui::vec2(118.0, 20.0), from_the_right, |ui| {
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
        response.on_hover_text(
            "The recorded run: drag to any moment, then play on from there; → and ← go a step",
        );
    });
}

/// The sliders of what the scene has of them, side by side.
fn sliders(ui: &mut Ui, state: &mut AppState) {
    let (index, Some(start)) = (state.selected, state.frame.start.clone()) else { return };
    let Some(before) = state.wanted.get(index).map(|wanted| wanted.settings) else { return };
    let mut settings = before;
    let controls: Vec<_> = shown_settings(state, &before)
        .into_iter()
        .filter(|about| FRONT_SETTINGS.contains(&about.name))
        .collect();
    let columns = ((ui.available_width() / LEAST_WIDTH) as usize).clamp(1, FRONT_SETTINGS.len());
    for row in controls.chunks(columns) {
        ui.columns(columns, |columns| {
            for (ui, about) in columns.iter_mut().zip(row) {
                if let (Some(rect), Some(control)) = (
                    setting_control::show(ui, about, &mut settings, start.settings()),
                    about.control,
                ) {
                    state.note_control(control.symbol, rect);
                }
            }
        });
    }
    if settings != before {
        state.set_from_front(index, settings);
    }
    if !ui.input(|input| input.pointer.any_down()) {
        state.start_again_with_draft();
    }
}

/// A sentence on what the sliders do.
fn what_to_try(ui: &mut Ui, state: &AppState) {
    let Some(settings) = state.world().map(|world| world.controls.settings) else { return };
    let text = if !state.preferences.starts_again && !state.frame.at_start() {
        LIVE
    } else if state.slumps() && !state.touring {
        budget::what_to_try(&settings)
    } else {
        return;
    };
    ui.add(egui::Label::new(RichText::new(text).small().weak()).truncate()).on_hover_text(text);
}

/// What is true of a value that changes while time passes.
const LIVE: &str = "A new value acts from the next step on. Bonds that hold stay as they are; a longer Δt in mid-fall presses \
                    fast grains into one another.";

impl AppState {
    /// Changes settings as the sliders of the front ask for it: at once, or with a new start once the mouse lets go.
    fn set_from_front(&mut self, world: usize, settings: Settings) {
        if self.preferences.starts_again {
            self.draft = Some((world, settings));
        } else {
            self.change(world, settings);
        }
    }

    /// Starts again with what a slider was set to.
    fn start_again_with_draft(&mut self) {
        let Some((world, settings)) = self.draft.take() else { return };
        let mut all: Vec<Settings> = self.wanted.iter().map(|wanted| wanted.settings).collect();
        let Some(changed) = all.get_mut(world) else { return };
        *changed = settings;
        self.wanted[world].settings = settings;
        self.live.send(Command::Compare(all));
        self.live.send(Command::Play);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setting::Group;
    use crate::world::Parameters;

    #[test]
    fn every_slider_of_the_front_is_a_declared_setting() {
        for name in FRONT_SETTINGS {
            let about = Parameters::ABOUT.iter().find(|about| about.name == name);
            assert!(about.is_some_and(|about| about.control.is_some()), "{name}");
        }
    }
}
