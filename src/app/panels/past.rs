//! In the panel of the run: earlier runs, to be gone back to, and the newest of them as a ghost.

use egui::{Button, Color32, Rect, RichText, Stroke, Ui};
use glam::DVec2;

use super::compare::title_among;
use crate::app::state::AppState;
use crate::live::{Command, Controls, PastRun, PastWorld};

/// Grains of a ghost at the most: more outlines would hide what is in front.
const MOST_OUTLINES: usize = 3_000;

/// Width of the fields of names, points.
const NAME_WIDTH: f32 = 84.0;

/// Shows the list, where there is any.
pub(super) fn show(ui: &mut Ui, state: &mut AppState) {
    if state.frame.past.is_empty() {
        return;
    }
    ui.horizontal(|ui| {
        ui.label("Earlier runs").on_hover_text(
            "What a reset, other worlds, or going on differently from an earlier moment has taken the place of. \
             The last four are kept.",
        );
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.checkbox(&mut state.preferences.ghost, "Ghost")
                .on_hover_text("Show the last of them: its curves in grey, its grains as outlines.");
        });
    });
    ui.horizontal(|ui| {
        ui.label(RichText::new("This run").size(11.5));
        let given = state.frame.name.clone();
        name_field(ui, state, None, &given);
    });
    let runs = state.frame.past.clone();
    for run in runs.iter().rev() {
        ui.horizontal(|ui| {
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                name_field(ui, state, Some(run.number), &run.name);
                return_button(ui, state, run);
            });
        });
    }
}

fn return_button(ui: &mut Ui, state: &mut AppState, run: &PastRun) {
    let about = format!("↶ {}, {:.3} s", name(run), run.recorded_secs);
    let text = match &*run.name {
        "" => about.clone(),
        name => format!("↶ {name}, {:.3} s", run.recorded_secs),
    };
    let button = Button::new(RichText::new(text).size(11.5)).truncate();
    let response = ui.add(button);
    if response.on_hover_text(format!("Back to it (the last: Ctrl Z): {about}")).clicked() {
        state.live.send(Command::Return(run.number));
    }
}

/// The field that names a run. What is typed is kept here until the field is left: a name comes back a step later.
fn name_field(ui: &mut Ui, state: &mut AppState, number: Option<u64>, given: &str) {
    let id = egui::Id::unique(("name of run", number));
    let typed = ui.data(|data| data.get_temp(id));
    let mut text: String = typed.unwrap_or_else(|| given.to_owned());
    let edit = egui::TextEdit::singleline(&mut text).desired_width(NAME_WIDTH).hint_text("name");
    let response = ui.add(edit);
    let label = number.map_or("Name of this run".into(), |number| format!("Name of run {number}"));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, &label));
    if response.changed() {
        state.live.send(Command::Name(number, text.clone()));
    }
    let has_focus = response.has_focus();
    ui.data_mut(|data| {
        if has_focus {
            data.insert_temp(id, text);
        } else {
            data.remove::<String>(id);
        }
    });
    response.on_hover_text("What to call it; sessions keep the name.");
}

/// What its worlds were.
fn name(run: &PastRun) -> String {
    let controls: Vec<Controls> = run.worlds.iter().map(|world| world.controls).collect();
    let first = title_among(&controls, 0);
    match controls.len() {
        0 | 1 => first,
        2 => format!("{first}; {}", title_among(&controls, 1)),
        count => format!("{count} worlds, {first}"),
    }
}

/// The run that shows as a ghost.
pub(super) fn ghost(state: &AppState) -> Option<&PastRun> {
    state.frame.past.last().filter(|_| state.preferences.ghost)
}

/// Draws the outlines of a world's ghost, by what takes a place (m) to one of the screen, and a length (m) to points.
pub(super) fn paint(
    ui: &Ui,
    world: &PastWorld,
    cell: Rect,
    to_screen: impl Fn(DVec2) -> egui::Pos2,
    points_per_metre: f64,
) {
    let grains = &world.snapshot.grains;
    if grains.len() > MOST_OUTLINES {
        return;
    }
    let painter = ui.painter().with_clip_rect(cell);
    let stroke = Stroke::new(1.0, Color32::from_gray(128).gamma_multiply(0.55));
    for grain in grains {
        let radius = (grain.radius * points_per_metre) as f32;
        painter.circle_stroke(to_screen(grain.position), radius, stroke);
    }
}
