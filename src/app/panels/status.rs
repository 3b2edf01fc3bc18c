//! The status bar, with the verdict on trust ("Can I trust this?"), the speed of the run, warnings, and buttons for
//! pages and help.

use egui::{Align, Label, Layout, Rect, RichText, Ui};

use super::alarms::alarms;
use super::trust::TrustPanel;
use crate::app::context::PanelContext;
use crate::app::page::Page;
use crate::app::theme;
use crate::live::LiveFrame;

/// Shows the status bar.
pub(super) fn show(
    ui: &mut Ui,
    context: &mut PanelContext<'_>,
    trust: &mut TrustPanel,
    help: &mut bool,
) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 10.0;
        let reason = trust.button(ui, context);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ways(ui, context, help);
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                pace(ui, &context.run.frame);
                messages(ui, context, reason);
            });
        });
    });
}

/// Shows the buttons of the status bar for pages and help, from right to left.
fn ways(ui: &mut Ui, context: &mut PanelContext<'_>, help: &mut bool) {
    ui.toggle_value(help, "Help").on_hover_text("All keys (H)");
    let page = context.preferences.page;
    let save = ui.selectable_label(page == Some(Page::Save), "Save…");
    context.note_control("save", save.rect);
    let hint = "Pictures, films, data, sessions, links";
    if save.on_hover_text(hint).clicked() {
        let is_open = page == Some(Page::Save);
        context.preferences.page = (!is_open).then_some(Page::Save);
    }
    let is_open = page.is_some_and(|page| page != Page::Save);
    let text = if is_open { "More ▴" } else { "More ▾" };
    let more = ui.selectable_label(is_open, text);
    context.note_control("more", more.rect);
    let hint = "Scenes, laws and solvers, comparisons, the look";
    if more.on_hover_text(hint).clicked() {
        context.preferences.page = (!is_open).then_some(Page::Pile);
    }
}

/// Shows the speed of the run while it plays.
fn pace(ui: &mut Ui, frame: &LiveFrame) {
    if frame.seeking {
        ui.label(RichText::new("computing that moment").weak());
    } else if frame.stored && frame.playing {
        ui.label(RichText::new("stored").weak())
            .on_hover_text("The record is shown; nothing is computed.");
    } else if frame.playing && frame.steps_per_sec > 0.0 {
        let text = format!("{:.0} steps/s, {:.2}×", frame.steps_per_sec, frame.real_time_factor);
        ui.label(RichText::new(text).weak())
            .on_hover_text("Steps of all worlds together, and simulated time per wall-clock time");
    }
}

/// Shows one message: the latest notice, otherwise a failure of the run, a warning, or the reason not to trust the run.
/// Lessons show no warnings, because some lessons demonstrate errors.
fn messages(ui: &mut Ui, context: &mut PanelContext<'_>, distrust: Option<String>) {
    if let Some((notice, left_secs)) =
        context.notice.as_ref().and_then(|it| Some((it, it.left_secs()?)))
    {
        ui.ctx().request_repaint_after_secs(left_secs);
        message(ui, &notice.text, notice.colour(ui));
        return;
    }
    let warning = theme::warning(ui.visuals().dark_mode);
    if let Some(failure) = context.run.frame.worlds.iter().find_map(|world| world.failure.clone()) {
        message(ui, &format!("{failure}. Drag the timeline back, or start again."), warning);
    } else if let Some(alarm) = alarms(context.run).into_iter().next().filter(|_| !context.touring)
    {
        let rect = message(ui, &format!("▲ {alarm}"), warning);
        context.note_control("alarm", rect);
    } else if let Some(reason) = distrust {
        message(ui, &reason, ui.visuals().weak_text_color());
    }
}

/// Shows a message as one line of text in the remaining space. If the line is cut off, a hover text shows the whole
/// text.
fn message(ui: &mut Ui, text: &str, colour: egui::Color32) -> Rect {
    // A truncated label shows its whole text by itself.
    ui.add(Label::new(RichText::new(text).color(colour)).truncate()).rect
}
