//! The status bar: where the run is, how fast, how well.

use egui::{Align, Label, Layout, RichText, Ui};

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
                ui.label(mono(format!("{:.2}× real time", state.frame.real_time_factor)));
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

/// Whether steps met the tolerance: the last one, and those before.
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
    let help = ui.selectable_label(state.shown.help, "Help (H)");
    if help.clicked() {
        state.shown.help = !state.shown.help;
    }
    let mut plots = state.preferences.plots;
    let toggle = ui.toggle_value(&mut plots, "Plots").on_hover_text("Show or hide the plots");
    state.note_control("Plots", toggle.rect);
    state.preferences.plots = plots;
    let mut sidebar = state.preferences.sidebar;
    ui.toggle_value(&mut sidebar, "Panels").on_hover_text("Show or hide the panels");
    state.preferences.sidebar = sidebar;

    let dark = ui.visuals().dark_mode;
    let showing = state.notice().is_some();
    let failure = state.frame.worlds.iter().find_map(|world| world.failure.clone());
    if let Some(failure) = failure.filter(|_| !showing) {
        let text = format!("{failure}. Drag the timeline back, or reset.");
        let label = Label::new(RichText::new(&text).color(theme::warning(dark))).truncate();
        ui.add(label).on_hover_text(text);
        return;
    }
    if let Some(alarm) = alarm(state).filter(|_| !showing) {
        let text = format!("▲ {alarm}");
        let label = Label::new(RichText::new(&text).color(theme::warning(dark))).truncate();
        let shown = ui.add(label).on_hover_text(text);
        state.note_control("alarm", shown.rect);
        return;
    }
    if let Some((notice, left)) = state.notice() {
        let colour = if notice.failure { theme::warning(dark) } else { theme::good(dark) };
        let label = Label::new(RichText::new(&notice.text).color(colour)).truncate();
        let text = notice.text.clone();
        ui.add(label).on_hover_text(text);
        ui.ctx().request_repaint_after_secs(left);
    }
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

/// Whether an alarm says what was chosen with open eyes: so many sweeps a step, solved or not. How many steps were
/// not solved is told beside it in any case.
fn is_asked_for(alarm: &WorldAlarm, world: &WorldFrame) -> bool {
    let fast = FAST.among(&world.snapshot.surroundings);
    alarm.kind == AlarmKind::SweepLimit && world.controls.settings.solver == fast
}
