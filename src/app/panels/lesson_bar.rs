//! The bar above the scene: the list of lessons and the text of the present one.

use egui::{Align, Button, ComboBox, Label, Layout, RichText, Ui};

use crate::app::context::{PanelContext, Request};
use crate::app::lessons::{LESSONS, Lesson, lesson};
use crate::app::theme;
use crate::app::watched_run::WatchedRun;
use crate::sim::Settings;

/// The bar above the scene.
#[derive(Default)]
pub(crate) struct LessonBar {
    /// The number of starts before that of the present lesson.
    pub loads_before: u64,
}

impl LessonBar {
    /// Shows the bar.
    pub(super) fn show(&self, ui: &mut Ui, context: &mut PanelContext<'_>) {
        let at = context.preferences.lesson.at.min(LESSONS.len() - 1);
        ui.horizontal(|ui| {
            let accent = theme::accent(ui.visuals().dark_mode);
            ui.label(RichText::new("Slump").heading().color(accent));
            list(ui, context, at);
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| ways(ui, context, at));
        });
        if context.touring {
            let is_changed = self.has_other_worlds(context.run, &LESSONS[at]);
            ui.label(if is_changed { OTHER_WORLDS } else { LESSONS[at].watch });
        }
    }

    /// True if worlds of a lesson are no longer those that it speaks of.
    fn has_other_worlds(&self, run: &WatchedRun, lesson: &Lesson) -> bool {
        let Some(start) = &run.frame.start else { return false };
        let worlds = (lesson.worlds)(*start.settings());
        let is_there = run.frame.loads > self.loads_before;
        let shown: Vec<Settings> =
            run.frame.worlds.iter().map(|world| world.controls.settings).collect();
        let held = || Settings::about().filter(|about| !(lesson.leaves_free)(about.name));
        let is_as_it_was = |(one, shown): (&Settings, &Settings)| {
            held().all(|about| one.get(about.name) == shown.get(about.name))
        };
        let are_all = shown.len() == worlds.len() && worlds.iter().zip(&shown).all(is_as_it_was);
        is_there && !are_all && held().next().is_some()
    }
}

/// The buttons, from the right: fold the bars, leave the lessons, go on, go back.
fn ways(ui: &mut Ui, context: &mut PanelContext<'_>, at: usize) {
    let dark = ui.visuals().dark_mode;
    let hint = "Fold the bars: the scene is the window (B)";
    let fold = ui.button("▴").on_hover_text(hint);
    fold.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, "Fold"));
    context.preferences.folded |= fold.clicked();
    if !context.touring {
        return;
    }
    let hint = "End the lessons; the worlds stay. They go on here when they are taken up again.";
    let leave = ui.button("Leave").on_hover_text(hint);
    context.note_control("leave lessons", leave.rect);
    if leave.clicked() {
        return context.ask(Request::LeaveLessons);
    }
    let next = RichText::new("Next ▶").color(theme::on_accent(dark));
    let next = ui.add_enabled(at + 1 < LESSONS.len(), Button::new(next).fill(theme::accent(dark)));
    context.note_control("next lesson", next.rect);
    let next = next.on_hover_text("The next lesson");
    if next.clicked() {
        context.ask(Request::Visit(at + 1));
    }
    let back = ui.add_enabled(at > 0, Button::new("◀ Back"));
    if back.on_hover_text("The lesson before").clicked() {
        context.ask(Request::Visit(at.saturating_sub(1)));
    }
    ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
        ui.add(Label::new(RichText::new(LESSONS[at].title).heading()).truncate());
    });
}

/// Lights the controls that the lesson asks for next, where all of the window is drawn.
pub(super) fn light(ui: &Ui, context: &PanelContext<'_>) {
    if !context.touring || context.run.frame.loading.is_some() {
        return;
    }
    let lesson = lesson(context.preferences.lesson.at);
    let stroke = egui::Stroke::new(2.0, theme::accent(ui.visuals().dark_mode));
    for name in (lesson.asks_for)(context.run, context.preferences) {
        if let Some(rect) = context.controls.get(*name) {
            let ring = rect.expand(3.0);
            ui.painter().rect_stroke(ring, 5.0, stroke, egui::StrokeKind::Outside);
        }
    }
}

/// What is said in place of a lesson's sentences where they are no longer true.
const OTHER_WORLDS: &str = "A number was changed: these are no longer the worlds of the lesson. The list above has \
    it as it was.";

/// All lessons, to be gone to; the one that was left is marked.
fn list(ui: &mut Ui, context: &mut PanelContext<'_>, at: usize) {
    let text = match context.touring {
        true => format!("Lesson {} of {}", at + 1, LESSONS.len()),
        false => "Lessons".to_owned(),
    };
    let mut asked = None;
    let shown =
        ComboBox::from_id_salt("lessons").selected_text(text).width(104.0).show_ui(ui, |ui| {
            for (number, lesson) in LESSONS.iter().enumerate() {
                let text = format!("{}. {}", number + 1, lesson.title);
                if ui.selectable_label(number == at, text).clicked() {
                    asked = Some(number);
                }
            }
        });
    let response = shown.response;
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, "Lessons"));
    context.note_control("lessons", response.rect);
    if let Some(number) = asked {
        context.ask(Request::Visit(number));
    }
}
