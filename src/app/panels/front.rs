//! The main controls: the buttons for start and restart, the speed of playing, the timeline, and the sliders for Bond,
//! Δt, restitution ρ and friction μ.

use egui::{Button, ComboBox, RichText, Slider, Ui};

use super::shown_settings::{FRONT_SETTINGS, shown_settings};
use crate::app::context::PanelContext;
use crate::app::lessons::lesson;
use crate::app::number_text::clock_text;
use crate::app::{budget, setting_control, theme};
use crate::live::Command;

/// Speeds of playing that the user can choose: simulated time per wall-clock time.
const PACES: [f64; 7] = [0.01, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0];

/// Smallest width of a main slider (for Bond, Δt, ρ or μ) with its number, points.
const LEAST_WIDTH: f32 = 150.0;
/// Space between two main sliders, points. With less space, a unit seems to belong to the next slider.
const SLIDER_GAP: f32 = 16.0;

pub(super) fn show(ui: &mut Ui, context: &mut PanelContext<'_>) {
    ui.add_enabled_ui(context.run.is_ready(), |ui| {
        ui.horizontal(|ui| {
            release_button(ui, context);
            let hint = "Start again with the present settings (R)";
            let again = ui.add(Button::new("⟲ Again").min_size(egui::vec2(0.0, 30.0)));
            if again.on_hover_text(hint).clicked() {
                context.run.live.send(Command::Reset);
            }
            pace(ui, context);
            timeline(ui, context);
        });
        ui.add_space(2.0);
        sliders(ui, context);
        ui.horizontal(|ui| {
            let hint = "On: when you let go of a slider, the pile starts again with the new value, and the earlier \
                        run stays as a ghost. Off: the new value acts from the next step on.";
            let name = "start again when I move a slider";
            let switch = ui.checkbox(&mut context.preferences.starts_again, name);
            context.note_control("start again", switch.on_hover_text(hint).rect);
            what_to_try(ui, context);
        });
    });
}

/// Shows the most important button, which starts, pauses or continues the run. In the initial state of a pile, it
/// removes the walls.
fn release_button(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let frame = &context.run.frame;
    let failed = frame.worlds.iter().any(|world| world.failure.is_some());
    let (text, hint) = if frame.playing {
        ("❚❚  Pause", "Stop time (space)")
    } else if frame.held() && !frame.replaying {
        ("▶  Release", "Remove the walls: the pile holds or slumps (space)")
    } else if frame.branching {
        (
            "▶  Continue",
            "Continue with the changed settings; the earlier run is kept under Compare (space)",
        )
    } else if frame.replaying {
        (
            "▶  Replay",
            "Show the record from this moment on, and continue to compute at its end (space)",
        )
    } else if frame.at_start() {
        ("▶  Start", "Let time pass (space)")
    } else if context.run.has_ended() {
        ("▶  Continue", "The scene has reached its end: let as much time pass again (space)")
    } else {
        ("▶  Resume", "Let time pass again from the visible moment (space)")
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
        context.run.toggle_play();
    }
    context.note_control("release", response.rect);
}

/// Shows the list of speeds of playing.
fn pace(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let preferences = &mut context.preferences;
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
    context.note_control("pace", response.rect);
    response.on_hover_text("Simulated time per wall-clock time ([ slower, ] faster)");
    let pace = context.preferences.pace();
    if pace != before {
        context.run.live.send(Command::SetPace(pace));
    }
}

/// Changes the speed of playing to the next smaller or larger speed of the list. Above the largest speed, the run is
/// computed as fast as the machine can.
pub(crate) fn change_pace(context: &mut PanelContext<'_>, is_faster: bool) {
    let now = context.preferences.speed;
    let mut paces = PACES.into_iter();
    let next = if is_faster {
        paces.find(|&pace| pace > now)
    } else {
        paces.rev().find(|&pace| pace < now)
    };
    context.preferences.full_speed = is_faster && next.is_none();
    context.preferences.speed = next.unwrap_or(now);
    context.run.live.send(Command::SetPace(context.preferences.pace()));
}

fn timeline(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let end = context.run.frame.recorded_secs();
    let now = context.run.frame.time_secs();
    let duration = context.run.duration_secs();
    let [now_text, end_text] = [now, end].map(clock_text);
    let label = format!("{} / {end_text}", now_text.trim_end_matches(" ms"));
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
            context.run.live.send(Command::Seek(at.min(end)));
        }
        context.note_control("timeline", response.rect);
        response.on_hover_text(
            "The recorded run: drag to any moment, then continue from there; → and ← move by one step.",
        );
    });
}

/// Shows those of the main sliders (for Bond, Δt, ρ and μ) that have an effect in the scene, side by side; in a lesson,
/// only the sliders of the lesson.
fn sliders(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let Some((before, start)) = context.run.wanted_and_start() else { return };
    let (index, mut settings) = (context.run.selected, before);
    let mut controls = shown_settings(context.run, &before);
    let shown = match context.touring {
        true => lesson(context.preferences.lesson.at).sliders,
        false => &FRONT_SETTINGS,
    };
    controls.retain(|about| shown.contains(&about.name));
    let columns = ((ui.available_width() / LEAST_WIDTH) as usize).clamp(1, shown.len());
    let spacing = std::mem::replace(&mut ui.spacing_mut().item_spacing.x, SLIDER_GAP);
    for row in controls.chunks(columns) {
        ui.columns(columns, |columns| {
            for (ui, about) in columns.iter_mut().zip(row) {
                ui.spacing_mut().item_spacing.x = spacing;
                if let (Some(rect), Some(control)) = (
                    setting_control::show(ui, about, &mut settings, start.settings()),
                    about.control,
                ) {
                    context.note_control(control.symbol, rect);
                }
            }
        });
    }
    ui.spacing_mut().item_spacing.x = spacing;
    match settings != before {
        true if context.preferences.starts_again => context.run.draft = Some((index, settings)),
        true => {
            context.run.change(index, settings);
            // In a lesson the change must act on a pile at rest.
            if context.touring && !context.run.frame.at_start() {
                context.run.live.send(Command::Play);
            }
        }
        false => {}
    }
    if !ui.input(|input| input.pointer.any_down()) {
        context.run.start_again_with_draft();
    }
}

/// Shows a warning if the time step is so long that a grain at rest falls too far in one step. Otherwise shows a hint
/// on the main sliders (Bond, Δt, ρ and μ), such as the effect of a longer Δt.
fn what_to_try(ui: &mut Ui, context: &PanelContext<'_>) {
    let Some(world) = context.run.world() else { return };
    let settings = world.controls.settings;
    let too_long = budget::too_long(&settings, &world.snapshot.surroundings, world.substeps);
    if let Some(warning) = too_long {
        let text = RichText::new(warning).small().color(theme::warning(ui.visuals().dark_mode));
        ui.add(egui::Label::new(text).truncate());
        return;
    }
    let selected =
        format!("These sliders change run {}, the framed one.", context.run.selected + 1);
    let text = if context.run.compares() && context.touring {
        Some(selected.as_str())
    } else if !context.preferences.starts_again && !context.run.frame.at_start() {
        Some(LIVE)
    } else if context.run.slumps() && !context.touring {
        budget::what_to_try(&settings)
    } else {
        None
    };
    let Some(text) = text else { return };
    ui.add(egui::Label::new(RichText::new(text).small().weak()).truncate()).on_hover_text(text);
}

/// Hint on a setting that the user changes during the run.
const LIVE: &str = "A new value acts from the next step on. A longer Δt in mid-fall presses fast grains into one another.";
