//! Panel: the scene and the number of grains, the earlier runs, and the command line.

use egui::{Align, Button, RichText, Ui};

use super::gallery::Gallery;
use super::shown_settings::FRONT_SETTINGS;
use crate::app::IN_BROWSER;
use crate::app::context::{PanelContext, Request};
use crate::app::number_text::clock_text;
use crate::app::provenance::CHANGED;
use crate::app::titles::{settings_text, title_among};
use crate::app::watched_run::WatchedRun;
use crate::config::Config;
use crate::live::{Command, PastRun};
use crate::scene::{Deposition, NewPile, SCENES, SceneGroup};

/// Groups of scenes in the gallery. Stability scenes (scenes that are hard for solvers) are not among them, because
/// they are for experts (page "Law, solver").
const SCENE_GROUPS: [SceneGroup; 2] = [SceneGroup::Paper, SceneGroup::Experiments];
/// Largest number of grains of a new pile that the panel offers. With more grains, the user would wait longer for the
/// pile and for each step. The command line allows more.
const MOST_GRAINS: usize = 20_000;

pub(super) fn show(ui: &mut Ui, context: &mut PanelContext<'_>, gallery: &mut Gallery) {
    scene_box(ui, context, gallery);
    if context.run.config().named() == Config::DEFAULT_SCENE {
        new_pile(ui, context);
    }
}

/// Shows the buttons that copy a command line or a link.
pub(super) fn command_line(ui: &mut Ui, context: &mut PanelContext<'_>) {
    ui.horizontal(|ui| {
        let copy = ui.button("Copy command line").on_hover_text(
            "Copies the command that computes the selected world from its initial state with the present settings, \
             without a window and to the last digit.",
        );
        if copy.clicked()
            && let Some(line) = context.run.command_line()
        {
            ui.ctx().copy_text(line);
            if context.run.world().is_some_and(|world| !world.is_even) {
                context.warn(format!("The command line is copied; {CHANGED}."));
            }
        }
        let way = match IN_BROWSER {
            true => "Open it in a browser, or paste it into this page (Ctrl V).",
            false => "Paste it into a window (Ctrl V), or pass it to slump --open.",
        };
        let hint = format!(
            "Copies a line of text that opens all worlds as they are now: scene, settings with their changes, and \
             the visible moment. {way}"
        );
        if ui.button("Copy link").on_hover_text(hint).clicked() {
            context.ask(Request::CopyLink);
        }
    });
}

fn scene_box(ui: &mut Ui, context: &mut PanelContext<'_>, gallery: &mut Gallery) {
    let current =
        context.run.frame.start.as_ref().map_or("", |start| start.scene.name.as_str()).to_owned();
    ui.horizontal(|ui| {
        let label = ui.label("Scene").on_hover_text(
            "To open a TOML scene, a CSV file of discs or a saved run, drop it on the window.",
        );
        ui.with_layout(egui::Layout::right_to_left(Align::Center), |ui| {
            gallery.show(ui, context, &current, &SCENE_GROUPS).labelled_by(label.id);
        });
    });
    if let Some(info) = SCENES.iter().find(|info| info.name == current) {
        // An equation is not broken at the end of a line.
        let summary = info.summary.replace(" = ", "\u{a0}=\u{a0}");
        ui.label(RichText::new(summary).small().weak());
    }
}

/// Shows the fields for a new pile (number of grains, box, seed, deposition) and the button that makes the pile.
fn new_pile(ui: &mut Ui, context: &mut PanelContext<'_>) {
    let id = egui::Id::unique("new pile");
    let typed = ui.data(|data| data.get_temp::<NewPile>(id));
    let mut pile = typed.unwrap_or_else(|| context.run.config().source.new_pile());
    ui.horizontal(|ui| {
        let label = ui.label("Grains");
        let grains = egui::DragValue::new(&mut pile.grains).range(1..=MOST_GRAINS).speed(2.0);
        let grains = ui.add(grains).labelled_by(label.id);
        if grains.on_hover_text("Number of grains of a new pile.").changed() {
            // In a box of this width, this number of grains becomes a pile as steep as the paper's pile.
            let paper = NewPile::default();
            let scale = (pile.grains as f64 / paper.grains as f64).sqrt();
            pile.box_width_in_diameters = (paper.box_width_in_diameters * scale).round();
        }
        let label = ui.label("Box");
        let width = egui::DragValue::new(&mut pile.box_width_in_diameters);
        ui.add(width.range(3.0..=1e4).max_decimals(1).suffix(" d").speed(0.5))
            .labelled_by(label.id)
            .on_hover_text(
                "Width of the box in diameters. With the number of grains it sets how high and steep the pile is.",
            );
    });
    ui.horizontal(|ui| {
        let label = ui.label("Seed");
        ui.add(egui::DragValue::new(&mut pile.seed).speed(0.1))
            .labelled_by(label.id)
            .on_hover_text("Another seed is another pile of the same kind.");
        for &way in Deposition::ALL {
            ui.selectable_value(&mut pile.deposition, way, way.name()).on_hover_text(way.hint());
        }
        let fresh = ui.button("New pile").on_hover_text("Make this pile and let it come to rest.");
        context.note_control("new pile", fresh.rect);
        if fresh.clicked() {
            let config = pile_like_this(context.run, &pile);
            context.ask(Request::Load(config.into()));
        }
    });
    ui.data_mut(|data| data.insert_temp(id, pile));
}

/// Returns the configuration of the new pile `pile` with the settings that the controls show.
fn pile_like_this(run: &WatchedRun, pile: &NewPile) -> Config {
    let mut config = run.config();
    config.source.scene = Some(Config::DEFAULT_SCENE.to_owned());
    config.source.initial = None;
    config.source.set_new_pile(pile);
    match run.wanted_settings() {
        Some(settings) => config.with_settings(&settings),
        None => config,
    }
}

/// Shows the earlier runs, if there are any: a button for each run, and a checkbox that shows the newest earlier run as
/// a ghost (grey outlines).
pub(super) fn earlier_runs(ui: &mut Ui, context: &mut PanelContext<'_>) {
    if context.run.frame.past.is_empty() {
        return;
    }
    ui.horizontal(|ui| {
        ui.label("Earlier runs").on_hover_text(
            "The runs of this session: Ctrl Z goes back by one run, Ctrl Y forward again. A click brings back a run \
             with its settings.",
        );
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.checkbox(&mut context.preferences.ghost, "Ghost")
                .on_hover_text("Show the newest earlier run: its curves in grey, its grains as outlines.");
        });
    });
    for run in context.run.frame.past.clone().iter().rev() {
        let title = title(run, context.run.slumps());
        let text = format!("{} {title}", if run.is_undone { "↷" } else { "↶" });
        let back = ui.add(Button::new(RichText::new(text).size(11.5)).truncate());
        let hint = format!("Bring back {title}, {}", clock_text(run.recorded_secs));
        if back.on_hover_text(hint).clicked() {
            context.run.live.send(Command::Return(run.number));
        }
    }
}

/// Returns a title for an earlier run. If the run has one simulation, the title contains Bond, Δt, ρ, μ and the slump.
/// If it has two, the title contains the settings of both in which they differ; if it has more, their number and these
/// settings of the first one.
fn title(run: &PastRun, slumps: bool) -> String {
    let settings: Vec<_> = run.worlds.iter().map(|world| world.controls.settings).collect();
    let first = title_among(&settings, 0);
    match settings.len() {
        0 => String::new(),
        1 => {
            let last = run.worlds[0].curve.last().filter(|_| slumps);
            let slump = last.map_or(String::new(), |row| format!(", slump {:.3}", row.slump));
            settings_text(&settings[0], &FRONT_SETTINGS) + &slump
        }
        2 => format!("{first}; {}", title_among(&settings, 1)),
        count => format!("{count} worlds, {first}"),
    }
}
