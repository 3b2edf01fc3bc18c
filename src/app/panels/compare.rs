//! Panel: worlds side by side.

use egui::{Button, RichText, Ui};

use super::physics::PAPER_TIME_STEPS;
use super::solver::method_box;
use crate::app::number::written;
use crate::app::state::AppState;
use crate::app::theme;
use crate::sim::live::{Command, Settings, Variant};
use crate::solver::METHODS;
use crate::world::{ContactLaw, FrictionCone};

/// Most worlds side by side.
pub const MOST_WORLDS: usize = 6;

/// The time steps at which the laws are compared, s.
const LAW_TIME_STEPS: [f64; 3] = [1e-4, 1e-3, 5e-3];

/// Shows the panel.
pub fn show(ui: &mut Ui, state: &mut AppState) {
    ui.label(
        RichText::new("Worlds from one initial state, kept at the same simulated time.")
            .small()
            .weak(),
    );
    presets(ui, state);
    if !state.compares() {
        return;
    }
    let mut removed = None;
    for index in 0..state.wanted.len() {
        if row(ui, state, index) {
            removed = Some(index);
        }
    }
    ui.horizontal(|ui| {
        let room = state.wanted.len() < MOST_WORLDS;
        if ui
            .add_enabled(room, Button::new("Add"))
            .on_hover_text("One more like the selected one.")
            .clicked()
        {
            let mut all = variants(state);
            all.push(all[state.selected]);
            state.live.send(Command::Compare(all));
        }
        if ui
            .button("One world")
            .on_hover_text("Go on with the selected world alone, from the start.")
            .clicked()
        {
            let one = variants(state)[state.selected];
            state.live.send(Command::Compare(vec![one]));
        }
    });
    if let Some(index) = removed {
        let mut all = variants(state);
        all.remove(index);
        state.live.send(Command::Compare(all));
    }
}

fn variants(state: &AppState) -> Vec<Variant> {
    state.wanted.iter().map(variant).collect()
}

fn variant(settings: &Settings) -> Variant {
    Variant { parameters: settings.parameters, solver: settings.solver }
}

fn presets(ui: &mut Ui, state: &mut AppState) {
    let Some(base) = state.wanted.get(state.selected).map(variant) else { return };
    let with = |bond: f64, time_step_secs: f64| {
        let mut variant = base;
        variant.parameters.bond = bond;
        variant.parameters.time_step_secs = time_step_secs;
        variant
    };
    ui.horizontal_wrapped(|ui| {
        let fig_4 =
            ui.button("Paper Fig. 4").on_hover_text("Bond 20 and 100 × Δt 1e-4, 1e-3 and 2e-3 s.");
        if fig_4.clicked() {
            let times = [1e-4, 1e-3, 2e-3];
            let all = [20.0, 100.0].iter().flat_map(|bond| times.map(|time| with(*bond, time)));
            state.live.send(Command::Compare(all.collect()));
        }
        let steps =
            ui.button("Six Δt").on_hover_text("This Bond with the six time steps of the paper.");
        if steps.clicked() {
            let all = PAPER_TIME_STEPS.map(|time| with(base.parameters.bond, time));
            state.live.send(Command::Compare(all.to_vec()));
        }
        let laws = ui
            .button("Two laws")
            .on_hover_text("Bond 20 at Δt 1e-4, 1e-3 and 5e-3 s, under the laws moreau and range.");
        if laws.clicked() {
            let of_law = |law| {
                LAW_TIME_STEPS.map(|time| {
                    let mut variant = with(20.0, time);
                    variant.parameters.law = law;
                    variant.solver.remedies = variant.solver.remedies.under(law);
                    variant.parameters.cone = FrictionCone::Shifted;
                    variant
                })
            };
            let all = [ContactLaw::Moreau, ContactLaw::Range].into_iter().flat_map(of_law);
            state.live.send(Command::Compare(all.collect()));
        }
        let bonds = ui.button("Four Bonds").on_hover_text("This Δt with Bond 0, 20, 50 and 100.");
        if bonds.clicked() {
            let all =
                [0.0, 20.0, 50.0, 100.0].map(|bond| with(bond, base.parameters.time_step_secs));
            state.live.send(Command::Compare(all.to_vec()));
        }
        if METHODS.len() > 1 {
            let methods = ui
                .button("Methods")
                .on_hover_text("As many methods as there is room for, on the same problem.");
            if methods.clicked() {
                let all = METHODS.iter().take(MOST_WORLDS).map(|info| {
                    let mut variant = base;
                    variant.solver.method = info.method;
                    variant
                });
                state.live.send(Command::Compare(all.collect()));
            }
        }
        if !state.compares()
            && ui.button("Two alike").on_hover_text("Two worlds, to be told apart.").clicked()
        {
            state.live.send(Command::Compare(vec![base, base]));
        }
    });
}

/// One world's row. Whether it is to be removed.
fn row(ui: &mut Ui, state: &mut AppState, index: usize) -> bool {
    let mut removed = false;
    ui.horizontal(|ui| {
        let colour = theme::world_colour(index, ui.visuals().dark_mode);
        let text = format!("■ {}", title(state, index));
        let name = RichText::new(text).color(colour);
        let selected = state.selected == index;
        let select = ui
            .selectable_label(selected, name)
            .on_hover_text("Physics and Solver are about this world.");
        if select.clicked() {
            state.selected = index;
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            removed = ui.small_button("✖").on_hover_text("Remove this world.").clicked();
            if METHODS.len() > 1 {
                let mut solver = state.wanted[index].solver;
                method_box(ui, ("method of world", index), &mut solver);
                if solver != state.wanted[index].solver {
                    state.set_solver(index, solver);
                }
            }
        });
    });
    removed
}

/// What tells a world from the others.
pub fn title(state: &AppState, index: usize) -> String {
    let Some(Settings { parameters, solver, .. }) = state.wanted.get(index) else {
        return String::new();
    };
    let methods_differ = state.wanted.iter().any(|other| other.solver.method != solver.method);
    let name =
        METHODS.iter().find(|info| info.method == solver.method).map_or("", |info| info.name);
    let method = if methods_differ { format!(", {name}") } else { String::new() };
    let laws_differ = state.wanted.iter().any(|other| other.parameters.law != parameters.law);
    let law = match parameters.law {
        _ if !laws_differ => "",
        ContactLaw::Moreau => "moreau, ",
        ContactLaw::Range => "range, ",
    };
    let step = written(parameters.time_step_secs);
    format!("{law}Bond {}, Δt {step} s{method}", written(parameters.bond))
}
