//! The bar above the scene, with the list of lessons and the text of the present lesson.

use egui::{Align, Align2, Button, ComboBox, Label, Layout, Rect, RichText, Ui};

use super::right_answer::{self, marked};
use crate::app::IN_BROWSER;
use crate::app::context::{PanelContext, Request};
use crate::app::glossary::explained;
use crate::app::lessons::{LESSONS, Lesson, lesson};
use crate::app::predictions::{Prediction, Question};
use crate::app::theme;
use crate::app::watched_run::WatchedRun;
use crate::number::millis_text;
use crate::sim::{Observables, Settings};

/// State of the bar above the scene, which shows the present lesson.
#[derive(Default)]
pub(crate) struct LessonBar {
    /// Number of initial states that the window had loaded when the user opened the present lesson. The window shows
    /// the run of the lesson once it has loaded more initial states than this; until then it still shows the run before
    /// the lesson.
    pub loads_before: u64,
    /// True while the summary of the lessons is open.
    pub shows_summary: bool,
    /// Height of the bar in the last frame, points.
    height: f32,
}

impl LessonBar {
    /// Shows the bar: the list of lessons, the buttons, and the text or question of the present lesson.
    pub(super) fn show(&mut self, ui: &mut Ui, context: &mut PanelContext<'_>) {
        let at = context.preferences.lesson.at.min(LESSONS.len() - 1);
        ui.horizontal(|ui| {
            let accent = theme::accent(ui.visuals().dark_mode);
            ui.label(RichText::new("Slump").heading().color(accent));
            list(ui, context, at);
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| self.ways(ui, context, at));
        });
        if !context.touring {
            self.shows_summary = false;
            right_answer::show(ui, context.run);
        } else if self.has_other_worlds(context.run, &LESSONS[at]) {
            ui.label(OTHER_WORLDS);
        } else if let Some(question) = &LESSONS[at].question {
            // Before the lesson is loaded, the frame is of another run.
            let is_there = context.run.frame.loads > self.loads_before;
            prediction(ui, context, at, (question, is_there));
        } else {
            explained(ui.label(LESSONS[at].watch), LESSONS[at].watch);
        }
        if self.shows_summary {
            summary(ui, context, &mut self.shows_summary);
        }
        // A line that was added in this frame is visible only in the next frame, which has a higher bar.
        let height = ui.min_rect().height();
        if height != std::mem::replace(&mut self.height, height) {
            ui.ctx().request_repaint();
        }
    }

    /// Shows the buttons of the bar, from right to left: hide the bars, leave the lessons, next lesson, previous
    /// lesson.
    fn ways(&mut self, ui: &mut Ui, context: &mut PanelContext<'_>, at: usize) {
        let dark = ui.visuals().dark_mode;
        let hint = "Fold the bars: the scene is the window (B)";
        let fold = ui.button("▴").on_hover_text(hint);
        fold.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, "Fold"));
        context.preferences.folded |= fold.clicked();
        if !context.touring {
            return;
        }
        let hint =
            "Leave the lessons. The worlds stay, and the list Lessons opens this lesson again.";
        let leave = ui.button("Leave").on_hover_text(hint);
        context.note_control("leave lessons", leave.rect);
        if leave.clicked() {
            return context.ask(Request::LeaveLessons);
        }
        let is_last = at + 1 == LESSONS.len();
        let (next, hint) = match is_last {
            true => ("Summary ▶", "What the lessons showed"),
            false => ("Next ▶", "The next lesson"),
        };
        let next = RichText::new(next).color(theme::on_accent(dark));
        let next = ui.add(Button::new(next).fill(theme::accent(dark)));
        context.note_control("next lesson", next.rect);
        if next.on_hover_text(hint).clicked() {
            self.shows_summary ^= is_last;
            if !is_last {
                context.ask(Request::Visit(at + 1));
            }
        }
        let back = ui.add_enabled(at > 0, Button::new("◀ Back"));
        if back.on_hover_text("The lesson before").clicked() {
            context.ask(Request::Visit(at.saturating_sub(1)));
        }
        ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
            ui.add(Label::new(RichText::new(LESSONS[at].title).heading()).truncate());
        });
    }

    /// True if the user has changed settings or the number of simulations of a lesson, so that its texts are no longer
    /// right.
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

/// Returns the result of the run as a sentence, if the run has only one pile, has ended, and has had the same Δt from
/// the start; otherwise `None`.
fn result_of_one(run: &WatchedRun) -> Option<String> {
    let [world] = &run.frame.worlds[..] else { return None };
    let Observables { time_step_secs, slump, .. } = world.snapshot.observables;
    let mut taken = world.curve.rows().filter(|row| row.step > 0);
    let is_one =
        run.has_ended() && run.slumps() && taken.all(|row| row.time_step_secs == time_step_secs);
    let step = millis_text(time_step_secs);
    is_one.then(|| format!("Computed with {step} from the start, the pile slumped by {slump:.3}."))
}

/// Shows the question of a lesson and its two answers or, when the run has decided the question, the result.
fn prediction(
    ui: &mut Ui,
    context: &mut PanelContext<'_>,
    at: usize,
    (question, is_there): (&Question, bool),
) {
    let rows = (question.rows)(&context.run.frame).filter(|_| is_there);
    let result = rows.and_then(|rows| (question.result)(&rows));
    let predicted = context.preferences.lesson.predictions.get_mut(&at);
    if let Some((right, text)) = result {
        let learnt = LESSONS[at].learnt;
        let Some(predicted) = predicted else {
            ui.label(text);
            ui.label(learnt);
            return;
        };
        let was_right = predicted.answer == right;
        predicted.was_right = Some(was_right);
        let said = question.answers[predicted.answer.min(1)];
        ui.label(marked(ui, was_right, &format!("You said: {said}. {text}")));
        ui.label(learnt);
        return;
    }
    let waits = is_there && context.run.frame.at_start() && !context.run.frame.playing;
    // Another run has decided the question before this run.
    if predicted.as_ref().is_some_and(|it| it.was_right.is_some()) && is_there && !waits {
        if let Some(result) = result_of_one(context.run) {
            ui.label(result);
        }
        ui.label(LESSONS[at].learnt);
        return;
    }
    explained(ui.label(LESSONS[at].watch), LESSONS[at].watch);
    let answer = predicted.map(|predicted| predicted.answer);
    let mut clicked = None;
    let mut buttons = Rect::NOTHING;
    ui.horizontal_wrapped(|ui| {
        ui.label(RichText::new(question.text).strong());
        // Without this space, the ring that highlights the answers would cover the question.
        ui.add_space(4.0);
        for (index, text) in question.answers.iter().enumerate() {
            let button = Button::selectable(answer == Some(index), *text).frame_when_inactive(true);
            let hint = "Your prediction. Choose it before you release the pile.";
            let button = ui.add_enabled(waits, button).on_hover_text(hint);
            buttons |= button.rect;
            if button.clicked() {
                clicked = Some(index);
            }
        }
    });
    context.note_control("answers", buttons);
    if let Some(answer) = clicked {
        let prediction = Prediction { answer, was_right: None };
        context.preferences.lesson.predictions.insert(at, prediction);
    }
}

/// Shows the summary of the lessons: the results of the predictions, what each lesson showed, and a button that copies
/// a link.
fn summary(ui: &Ui, context: &mut PanelContext<'_>, is_open: &mut bool) {
    let predictions = context.preferences.lesson.predictions.clone();
    let known = predictions.values().filter_map(|prediction| prediction.was_right);
    let (right, count) = known.fold((0, 0), |(right, all), is| (right + usize::from(is), all + 1));
    egui::Window::new("What the lessons showed")
        .anchor(Align2::CENTER_CENTER, [0.0, 0.0])
        .collapsible(false)
        .resizable(false)
        .open(is_open)
        .show(ui.ctx(), |ui| {
            ui.set_max_width(460.0);
            if count > 0 {
                ui.label(format!("{right} of your {count} predictions were right."));
            }
            for (at, Lesson { title, learnt, .. }) in LESSONS.iter().enumerate() {
                let title = format!("{}. {title}", at + 1);
                let was_right = predictions.get(&at).and_then(|prediction| prediction.was_right);
                let title = match was_right {
                    Some(was_right) => marked(ui, was_right, &title),
                    None => RichText::new(title),
                };
                ui.label(title.strong());
                ui.label(*learnt);
            }
            ui.separator();
            ui.horizontal(|ui| {
                let hint = match IN_BROWSER {
                    true => "A line of text that opens the present pile in a browser.",
                    false => "A line of text that opens the present pile. Paste it into another window (Ctrl V).",
                };
                if ui.button("Copy a link to this pile").on_hover_text(hint).clicked() {
                    context.ask(Request::CopyLink);
                }
                if ui.button("Begin again").on_hover_text("Go to lesson 1").clicked() {
                    context.preferences.lesson.predictions.clear();
                    context.ask(Request::Visit(0));
                }
            });
        });
}

/// Highlights the controls that the user should use next in the lesson.
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

/// Text that replaces the texts of a lesson when the user has changed its simulations.
const OTHER_WORLDS: &str = "A number was changed: these are no longer the worlds of the lesson. To restore them, \
    choose the lesson in the list above.";

/// Shows the list from which the user chooses a lesson; the present lesson is marked.
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
