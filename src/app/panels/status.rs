//! The status bar: where the run is, how fast, how well.

use egui::{Align, Color32, Label, Layout, Rect, RichText, Ui};

use crate::app::budget::FAST;
use crate::app::state::AppState;
use crate::app::theme;
use crate::live::{WorldAlarm, WorldFrame};
use crate::sim::AlarmKind;

/// Shows the bar.
pub(crate) fn show(ui: &mut Ui, state: &mut AppState) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 12.0;
        if let Some(world) = state.world() {
            let last = &world.snapshot.observables;
            let mono = |text: String| RichText::new(text).monospace();
            ui.label(mono(format!("t = {:.4} s", last.time_secs))).on_hover_text("Simulated time");
            ui.label(mono(format!("step {}", last.step)));
            if state.frame.playing && state.frame.steps_per_sec > 0.0 {
                ui.label(mono(format!("{:.0} steps/s", state.frame.steps_per_sec)))
                    .on_hover_text("Steps of all worlds together");
                let factor = state.frame.real_time_factor;
                let text = mono(format!("{factor:.2}× real time"));
                let is_behind =
                    !state.preferences.full_speed && factor < 0.8 * state.preferences.speed;
                let warning = theme::warning(ui.visuals().dark_mode);
                ui.label(if is_behind { text.color(warning) } else { text });
            }
            convergence(ui, state, world);
            if state.frame.stored {
                ui.label(RichText::new("stored").weak())
                    .on_hover_text("What is recorded is shown as it was; nothing is computed.");
            }
            if state.frame.seeking {
                ui.label(RichText::new("computing that moment").weak());
            }
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| messages(ui, state));
    });
}

/// How many steps met the tolerance: the last one, and those before.
fn convergence(ui: &mut Ui, state: &AppState, world: &WorldFrame) {
    let dark = ui.visuals().dark_mode;
    let last = || state.frame.worlds.iter().map(|world| &world.snapshot.observables);
    let (mark, colour) = if last().all(|row| row.step == 0) {
        ("○ no step yet", ui.visuals().weak_text_color())
    } else if last().all(|row| row.converged) {
        ("● converged", theme::good(dark))
    } else if last().all(|row| row.converged || row.fell_back == Some(true)) {
        ("◆ fell back", theme::warning(dark))
    } else {
        ("▲ not converged", theme::warning(dark))
    };
    ui.label(RichText::new(mark).color(colour)).on_hover_text(
        "Whether the last step met the tolerance within the sweep limit, or was solved under bounds of \
         friction instead: see Solver",
    );
    if world.unconverged_steps > 0 {
        let steps = if world.unconverged_steps == 1 { "step" } else { "steps" };
        let instead = match world.fallback_steps {
            0 => String::new(),
            fallback_steps => format!(", {fallback_steps} fell back"),
        };
        let text = format!("{} {steps} did not converge{instead}", world.unconverged_steps);
        ui.label(RichText::new(text).weak()).on_hover_text("Up to the moment that is shown");
    }
}

fn messages(ui: &mut Ui, state: &mut AppState) {
    ui.toggle_value(&mut state.shown.help, "Help (H)");
    let plots = ui.toggle_value(&mut state.preferences.plots, "Plots");
    state.note_control("Plots", plots.on_hover_text("Show or hide the plots").rect);
    ui.toggle_value(&mut state.preferences.sidebar, "Panels")
        .on_hover_text("Show or hide the panels");
    if let Some((notice, left)) = state.notice() {
        let (text, colour) = (notice.text.clone(), notice.colour(ui));
        ui.ctx().request_repaint_after_secs(left);
        message(ui, &text, colour);
        return;
    }
    let warning = theme::warning(ui.visuals().dark_mode);
    if let Some(failure) = state.frame.worlds.iter().find_map(|world| world.failure.clone()) {
        message(ui, &format!("{failure}. Drag the timeline back, or reset."), warning);
    } else if let Some(alarm) = alarm(state) {
        let rect = message(ui, &format!("▲ {alarm}"), warning);
        state.note_control("alarm", rect);
    }
}

/// Shows a line in the room that is left, and all of it to whoever points at it.
fn message(ui: &mut Ui, text: &str, colour: Color32) -> Rect {
    let label = Label::new(RichText::new(text).color(colour)).truncate();
    ui.add(label).on_hover_text(text).rect
}

/// The newest alarm of the selected world, or of any other, with its title where worlds are compared; one of the
/// present settings before those of earlier ones.
fn alarm(state: &AppState) -> Option<String> {
    let newest = |index: usize| {
        let world = state.frame.worlds.get(index)?;
        let is_news = |alarm: &&WorldAlarm| !is_asked_for(alarm, world);
        let alarms = || world.alarms.iter().filter(is_news).rev();
        let alarm = alarms().find(|alarm| !alarm.is_earlier).or_else(|| alarms().next())?;
        Some(if state.compares() {
            format!("{}: {}", super::compare::title(state, index), alarm.text)
        } else {
            alarm.text.to_string()
        })
    };
    newest(state.selected).or_else(|| (0..state.frame.worlds.len()).find_map(newest))
}

/// True where an alarm says what was chosen with open eyes: so many sweeps a step, solved or not. How many steps were
/// not solved is told beside it in any case.
fn is_asked_for(alarm: &WorldAlarm, world: &WorldFrame) -> bool {
    let fast = FAST.among(&world.snapshot.surroundings);
    alarm.kind == AlarmKind::SweepLimit && world.controls.settings.solver == fast
}
