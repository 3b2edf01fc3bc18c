//! Panel: which scene, how many grains, how fast.

use egui::{Align, ComboBox, RichText, Slider, Ui};

use crate::app::state::AppState;
use crate::app::theme;
use crate::scene::{Config, NewPile, Origin, SCENES, SceneGroup};
use crate::sim::live::Command;

/// Most grains that the panel offers; the command line takes more.
const MOST_GRAINS: usize = 20_000;
/// Ends of the speed slider, simulated time per time on the wall.
const SPEEDS: [f64; 2] = [0.01, 10.0];

/// What is typed for a new pile.
#[derive(Clone, PartialEq)]
struct Draft {
    grains: usize,
    seed: u64,
}

/// Shows the panel.
pub(crate) fn show(ui: &mut Ui, state: &mut AppState) {
    scene_box(ui, state);
    if state.config.origin.scene.as_deref().unwrap_or(Config::DEFAULT_SCENE)
        == Config::DEFAULT_SCENE
    {
        new_pile(ui, state);
    }
    loading(ui, state);
    speed(ui, state);
}

fn scene_box(ui: &mut Ui, state: &mut AppState) {
    let current = state.frame.start.as_ref().map_or("", |start| start.name.as_str()).to_owned();
    ui.horizontal(|ui| {
        let label = ui.label("Scene").on_hover_text(
            "Drop a TOML scene, a CSV of discs or a saved run on the window to open it.",
        );
        ui.with_layout(egui::Layout::right_to_left(Align::Center), |ui| {
            let list = ComboBox::from_id_salt("scene").width(150.0).selected_text(&current);
            let shown = list.show_ui(ui, |ui| {
                for group in SceneGroup::ALL {
                    ui.label(RichText::new(group.title()).small().weak());
                    for info in SCENES.iter().filter(|info| info.group == group) {
                        let entry = ui.selectable_label(info.name == current, info.name);
                        if entry.on_hover_text(info.summary).clicked() {
                            state.load(Config::of_scene(info.name));
                        }
                    }
                }
            });
            shown.response.labelled_by(label.id);
        });
    });
    let info = SCENES.iter().find(|info| info.name == current);
    if let Some(info) = info {
        ui.label(RichText::new(info.summary).small().weak());
    }
}

fn new_pile(ui: &mut Ui, state: &mut AppState) {
    let NewPile { grains, seed, .. } = state.config.origin.new_pile();
    let id = egui::Id::unique("new pile");
    let mut draft = ui.data(|data| data.get_temp(id)).unwrap_or(Draft { grains, seed });
    ui.horizontal(|ui| {
        let label = ui.label("Grains");
        ui.add(egui::DragValue::new(&mut draft.grains).range(1..=MOST_GRAINS).speed(2.0))
            .labelled_by(label.id)
            .on_hover_text("Number of grains of a new pile.");
        let label = ui.label("Seed");
        ui.add(egui::DragValue::new(&mut draft.seed).speed(0.1))
            .labelled_by(label.id)
            .on_hover_text("Another seed is another pile of the same kind.");
        let fresh = ui.button("New pile").on_hover_text(
            "Rain a pile and let it settle: seconds for hundreds of grains, minutes for thousands. \
             Where the window was opened with --deposition drop-and-roll, seconds for thousands.",
        );
        if fresh.clicked() {
            let config = pile_like_this(state, draft.clone());
            state.load(config);
        }
    });
    ui.data_mut(|data| data.insert_temp(id, draft));
}

/// A new pile with the numbers that the controls show.
fn pile_like_this(state: &AppState, Draft { grains, seed }: Draft) -> Config {
    let origin = Origin {
        scene: Some(Config::DEFAULT_SCENE.to_owned()),
        grains: Some(grains),
        seed: Some(seed),
        initial: None,
        ..state.config.origin.clone()
    };
    let config = Config { origin, ..state.config.clone() };
    match state.wanted.get(state.selected) {
        Some(wanted) => config.with_settings(&wanted.settings),
        None => config,
    }
}

fn loading(ui: &mut Ui, state: &mut AppState) {
    let Some(progress) = state.frame.loading.clone() else { return };
    ui.horizontal(|ui| {
        if ui.button("Cancel").clicked() {
            state.live.send(Command::CancelLoading);
        }
        let bar = ui.add(egui::ProgressBar::new(progress.part).desired_height(14.0));
        bar.widget_info(|| {
            egui::WidgetInfo::labeled(egui::Role::ProgressIndicator, true, "Loading")
        });
    });
    ui.label(RichText::new(progress.text).small().weak());
}

fn speed(ui: &mut Ui, state: &mut AppState) {
    let before = (state.preferences.speed, state.preferences.full_speed);
    ui.horizontal(|ui| {
        ui.label("Speed").on_hover_text("Simulated time per time on the wall.");
        ui.with_layout(egui::Layout::right_to_left(Align::Center), |ui| {
            ui.toggle_value(&mut state.preferences.full_speed, "max")
                .on_hover_text("As fast as the machine computes.");
            ui.label(RichText::new(format!("{:.2}×", state.preferences.speed)).monospace());
            ui.spacing_mut().slider_width = (ui.available_width() - 8.0).max(40.0);
            let slider = Slider::new(&mut state.preferences.speed, SPEEDS[0]..=SPEEDS[1])
                .logarithmic(true)
                .show_value(false);
            let response = ui.add(slider);
            response.widget_info(|| egui::WidgetInfo::slider(true, before.0, "Speed"));
            if response.changed() {
                state.preferences.full_speed = false;
            }
        });
    });
    // A run that has just begun has no speed yet.
    if state.frame.playing && state.frame.steps_per_sec > 0.0 {
        let factor = state.frame.real_time_factor;
        let behind = !state.preferences.full_speed && factor < 0.8 * state.preferences.speed;
        let dark = ui.visuals().dark_mode;
        let mut text = RichText::new(format!("running at {factor:.3} × real time")).small();
        text = if behind { text.color(theme::warning(dark)) } else { text.weak() };
        ui.label(text);
    }
    if before != (state.preferences.speed, state.preferences.full_speed) {
        state.live.send(Command::SetPace(state.preferences.pace()));
    }
}
