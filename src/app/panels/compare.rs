//! Panel: worlds side by side.

use egui::{Button, RichText, Ui};

use super::physics::PAPER_TIME_STEPS;
use crate::app::effort::FIGURES;
use crate::app::method_box::method_box;
use crate::app::number::written;
use crate::app::state::AppState;
use crate::app::theme;
use crate::sim::live::{Command, Controls};
use crate::sim::{Settings, Stepper};
use crate::solver::{Fallback, FrictionModel, METHODS, Method, MethodInfo, SolverSettings};
use crate::study::{FIG4_BONDS, FIG4_TIME_STEPS_SECS};
use crate::world::FrictionCone;

/// Most worlds side by side.
pub(crate) const MOST_WORLDS: usize = 6;

/// Shows the panel.
pub(crate) fn show(ui: &mut Ui, state: &mut AppState) {
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

fn variants(state: &AppState) -> Vec<Settings> {
    state.wanted.iter().map(|wanted| wanted.settings).collect()
}

/// Worlds that one click sets side by side.
struct LineUp {
    name: &'static str,
    hint: &'static str,
    /// Made of the settings of the selected world.
    worlds: fn(Settings) -> Vec<Settings>,
}

const LINE_UPS: [LineUp; 7] = [
    LineUp {
        name: "Paper Fig. 4",
        hint: "Bond 20 and 100 × Δt 1e-4, 1e-3 and 2e-3 s, each step solved as for the figure.",
        worlds: |base| {
            let base = Settings { solver: FIGURES.settings, ..stepped(base, Stepper::Moreau) };
            let of_bond = |bond| FIG4_TIME_STEPS_SECS.map(|secs| with(base, bond, secs));
            FIG4_BONDS.into_iter().flat_map(of_bond).collect()
        },
    },
    LineUp {
        name: "Six Δt",
        hint: "This Bond with the six time steps of the paper.",
        worlds: |base| PAPER_TIME_STEPS.map(|secs| with(base, base.parameters.bond, secs)).into(),
    },
    LineUp {
        name: "Two laws",
        hint: "Bond 20 at Δt 1e-4, 1e-3 and 5e-3 s, under the laws moreau and range.",
        worlds: |base| {
            let of_law = |law| [1e-4, 1e-3, 5e-3].map(|secs| stepped(with(base, 20.0, secs), law));
            [Stepper::Moreau, Stepper::Range].into_iter().flat_map(of_law).collect()
        },
    },
    LineUp {
        name: "Four Bonds",
        hint: "This Δt with Bond 0, 20, 50 and 100.",
        worlds: |base| {
            [0.0, 20.0, 50.0, 100.0]
                .map(|bond| with(base, bond, base.parameters.time_step_secs))
                .into()
        },
    },
    LineUp {
        name: "Methods",
        hint: "As many methods as there is room for, on the same problem.",
        worlds: |base| {
            let by = |info: &MethodInfo| Settings { solver: base.solver.by(info.method), ..base };
            METHODS.iter().take(MOST_WORLDS).map(by).collect()
        },
    },
    LineUp {
        name: "Friction",
        hint: "Every model of friction, and tresca solved four times a step, by nsgs.",
        worlds: |base| {
            let base = stepped(base, Stepper::Moreau);
            let by = |friction_model, model_solves| {
                let method = Method::Nsgs;
                // Coulomb's law would else be mixed with tresca.
                let fallback = Fallback::None;
                let by_it = SolverSettings { method, fallback, ..base.solver };
                let solver = SolverSettings { friction_model, model_solves, ..by_it };
                Settings { solver, ..base }
            };
            let once = FrictionModel::ALL.iter().map(|&model| by(model, 1));
            once.chain([by(FrictionModel::Tresca, 4)]).collect()
        },
    },
    LineUp {
        name: "Steppers",
        hint: "As many ways to step as there is room for, from the same state.",
        worlds: |base| {
            let by = |&stepper: &Stepper| stepped(base, stepper);
            Stepper::ALL.iter().take(MOST_WORLDS).map(by).collect()
        },
    },
];

fn with(mut base: Settings, bond: f64, time_step_secs: f64) -> Settings {
    base.parameters.bond = bond;
    base.over(time_step_secs)
}

/// With another stepper, and with nothing that it does not take.
fn stepped(base: Settings, stepper: Stepper) -> Settings {
    let mut settings = Settings { stepper, ..base };
    settings.parameters.cone = FrictionCone::Shifted;
    settings.with_only_what_is_taken()
}

fn presets(ui: &mut Ui, state: &mut AppState) {
    let Some(base) = state.wanted.get(state.selected).map(|wanted| wanted.settings) else { return };
    ui.horizontal_wrapped(|ui| {
        for LineUp { name, hint, worlds } in &LINE_UPS {
            if ui.button(*name).on_hover_text(*hint).clicked() {
                state.live.send(Command::Compare(worlds(base)));
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
                let before = state.wanted[index].settings;
                let mut settings = before;
                if before.stepper.uses_method() {
                    method_box(ui, ("method of world", index), &mut settings.solver);
                }
                if settings != before {
                    state.change(index, settings);
                }
            }
        });
    });
    removed
}

/// What tells a world from the others.
pub(crate) fn title(state: &AppState, index: usize) -> String {
    title_among(&state.wanted, index)
}

/// What tells one of such worlds from the others.
pub(super) fn title_among(worlds: &[Controls], index: usize) -> String {
    let Some(&Controls { settings, .. }) = worlds.get(index) else {
        return String::new();
    };
    let Settings { stepper, parameters, solver, .. } = settings;
    let differ =
        |other: &dyn Fn(&Settings) -> bool| worlds.iter().any(|wanted| other(&wanted.settings));
    let methods_differ = differ(&|other| other.solver.method != solver.method);
    let method = if methods_differ { format!(", {}", solver.method) } else { String::new() };
    let models_differ = differ(&|other| {
        let of = |solver: &SolverSettings| (solver.friction_model, solver.model_solves);
        of(&other.solver) != of(&solver)
    });
    let model = match (models_differ, solver.model_solves) {
        (false, _) => String::new(),
        (true, 1) => format!(", {}", solver.friction_model),
        (true, solves) => format!(", {} × {solves}", solver.friction_model),
    };
    let steppers_differ = differ(&|other| other.stepper != stepper);
    let stepper = if steppers_differ { format!("{stepper}, ") } else { String::new() };
    let step = written(parameters.time_step_secs);
    format!("{stepper}Bond {}, Δt {step} s{method}{model}", written(parameters.bond))
}
