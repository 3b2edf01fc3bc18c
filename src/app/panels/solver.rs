//! Panel: how each step is solved, and how well that went.

use egui::{ComboBox, RichText, Ui};

use crate::app::number::Number;
use crate::app::state::AppState;
use crate::app::theme;
use crate::scene::Preset;
use crate::sim::live::StartInfo;
use crate::solver::{
    MAX_SUBSTEPS, METHODS, Method, MethodKind, Ordering, Remedies, SolverSettings, StopTest, picked,
};
use crate::world::ContactLaw;

/// The stopping tests, as the panel calls them.
const STOP_TESTS: [(StopTest, &str, &str); 3] = [
    (StopTest::RelativeChange, "relative change", "‖ΔP‖ of a sweep over ‖P‖"),
    (StopTest::ImpulsePerMass, "Σ|ΔP|/m", "sum of |ΔP| of a sweep over the mean mass, m/s"),
    (StopTest::Residual, "residual", "the residual that judges all methods"),
];

/// The orders of a sweep, as the panel calls them.
const ORDERINGS: [(Ordering, &str, &str); 5] = [
    (Ordering::Interleaved, "interleaved", "distant contacts in turn: the fastest sweep"),
    (Ordering::Detected, "as detected", "sorted by grain"),
    (Ordering::BottomUp, "bottom up", "from the lowest contact to the highest"),
    (Ordering::Symmetric, "symmetric", "interleaved, every second sweep backward"),
    (Ordering::Coloured, "coloured", "contacts that share no grain follow each other"),
];

/// Shows the panel.
pub fn show(ui: &mut Ui, state: &mut AppState) {
    let index = state.selected;
    let (Some(wanted), Some(start)) = (state.wanted.get(index), state.frame.start.clone()) else {
        return;
    };
    let before = wanted.solver;
    let mut solver = before;
    egui::Grid::new("solver").num_columns(2).spacing([8.0, 5.0]).show(ui, |ui| {
        ui.label("Method").on_hover_text("How the impulses of a step are found.");
        method_box(ui, "method", &mut solver);
        ui.end_row();
        if solver.method.sweeps_in_order() {
            let label = ui.label("Order").on_hover_text("In which order a sweep visits contacts.");
            let list = ComboBox::from_id_salt("ordering").width(150.0);
            let named = ORDERINGS.iter().find(|(ordering, ..)| *ordering == solver.ordering);
            let shown = list.selected_text(named.map_or("", |(_, name, _)| name));
            let shown = shown.show_ui(ui, |ui| {
                for (ordering, name, hint) in ORDERINGS {
                    let choice = ui.selectable_value(&mut solver.ordering, ordering, name);
                    choice.on_hover_text(hint);
                }
            });
            shown.response.labelled_by(label.id);
            ui.end_row();
        }
    });
    match before.method.kind() {
        MethodKind::Problem => stop_controls(ui, &mut solver, &start),
        MethodKind::Scheme(_) => substep_controls(ui, &mut solver, &start),
    }
    // Springs carry their stretch on whether asked to or not.
    if before.method != Method::Dem {
        ui.checkbox(&mut solver.warm_start, "Warm start")
            .on_hover_text("Each step starts from the impulses of the one before.");
    }
    if before.method.kind() == MethodKind::Problem {
        let law = wanted.parameters.law;
        ui.add_enabled_ui(law == ContactLaw::Moreau, |ui| remedy_boxes(ui, &mut solver.remedies));
    }
    let robust = ui.button("Robust").on_hover_text(
        "Newton to 1e-8, overlap pushed out, shocks in sequence, no bounce below 2 g Δt, fast grains \
         in pieces of a step: hard scenes hold, and the paper's effects of Δt go.",
    );
    if robust.clicked() {
        let mut parameters = state.wanted[index].parameters;
        Preset::Robust.apply_to_settings(&mut parameters, &mut solver);
        state.set_parameters(index, parameters);
    }
    if solver != before {
        state.set_solver(index, solver);
    }
    readings(ui, state);
}

/// Known remedies for known failures. The law range has its own ways.
fn remedy_boxes(ui: &mut Ui, remedies: &mut Remedies) {
    let no_need = "The law range has its own way for this.";
    let Remedies { push_out, calm_unsolved, sequential_impacts, speculative, .. } = remedies;
    for (on, name, hint) in [
        (
            push_out,
            "Push overlap out",
            "Grains that overlap are moved apart after each step, without speed.",
        ),
        (
            calm_unsolved,
            "Calm unsolved steps",
            "A step that did not converge is solved once more without bounces, which may contradict \
             each other.",
        ),
        (
            sequential_impacts,
            "Shocks in sequence",
            "Shocks run through touching grains one after the other, as in Newton's cradle; not \
             where Bond is above 0.",
        ),
        (
            speculative,
            "Look ahead",
            "Pairs that would meet within a step close their gap and no more: nothing tunnels, but \
             they hardly bounce.",
        ),
    ] {
        ui.checkbox(on, name).on_hover_text(hint).on_disabled_hover_text(no_need);
    }
}

/// When a method that solves the step's problem is done.
fn stop_controls(ui: &mut Ui, solver: &mut SolverSettings, start: &StartInfo) {
    let before = *solver;
    egui::Grid::new("stops").num_columns(2).spacing([8.0, 5.0]).show(ui, |ui| {
        let label = ui.label("Stops on").on_hover_text("What the tolerance refers to.");
        let list = ComboBox::from_id_salt("stop").width(150.0);
        let shown = list.selected_text(stop_name(solver.stop)).show_ui(ui, |ui| {
            for (test, name, hint) in STOP_TESTS {
                ui.selectable_value(&mut solver.stop, test, name).on_hover_text(hint);
            }
        });
        shown.response.labelled_by(label.id);
        ui.end_row();
    });
    let tolerance = Number {
        label: "Tolerance",
        unit: if solver.stop == StopTest::ImpulsePerMass { "m/s" } else { "" },
        hint: "How well each step is solved; the answer depends on it.",
        range: [1e-12, 1e-1],
        logarithmic: true,
        default: start.solver.tolerance,
        refuse: &|value| refusal(SolverSettings { tolerance: value, ..before }),
    };
    solver.tolerance = tolerance.show(ui, before.tolerance).value.unwrap_or(solver.tolerance);
    tolerance_buttons(ui, solver);
    let sweeps = Number {
        label: "Sweep limit",
        unit: "",
        hint: "A step that needs more sweeps (or iterations) is reported as not converged.",
        range: [1.0, 100_000.0],
        logarithmic: true,
        default: f64::from(start.solver.max_sweeps),
        refuse: &refuse_sweeps,
    };
    if let Some(value) = sweeps.show(ui, f64::from(before.max_sweeps)).value {
        solver.max_sweeps = value.round().clamp(1.0, f64::from(u32::MAX)) as u32;
    }
}

/// How finely a scheme steps.
fn substep_controls(ui: &mut Ui, solver: &mut SolverSettings, start: &StartInfo) {
    let substeps = Number {
        label: "Substeps",
        unit: "",
        hint: "Substeps of each step; 0 takes 4 for tgs-soft, and as many as keep dem stable.",
        range: [0.0, 100.0],
        logarithmic: false,
        default: f64::from(start.solver.substeps),
        refuse: &refuse_substeps,
    };
    if let Some(value) = substeps.show(ui, f64::from(solver.substeps)).value {
        solver.substeps = value.round().clamp(0.0, f64::from(MAX_SUBSTEPS)) as u32;
    }
}

/// Care and speed, one click away.
fn tolerance_buttons(ui: &mut Ui, solver: &mut SolverSettings) {
    if solver.stop != StopTest::RelativeChange {
        return;
    }
    ui.horizontal(|ui| {
        for (tolerance, name, hint) in [
            (1e-3, "1e-3 fast", "For a look: piles slump that hold when solved well."),
            (1e-6, "1e-6 live", "For watching a pile."),
            (1e-7, "1e-7 figures", "For what is to be published; slower."),
        ] {
            let text = RichText::new(name).size(11.5);
            let button = egui::Button::selectable(solver.tolerance == tolerance, text);
            if ui.add(button).on_hover_text(hint).clicked() {
                solver.tolerance = tolerance;
            }
        }
    });
}

/// A list of all methods.
pub fn method_box(
    ui: &mut Ui,
    salt: impl std::hash::Hash + std::fmt::Debug,
    solver: &mut SolverSettings,
) {
    let name =
        |method| METHODS.iter().find(|info| info.method == method).map_or("", |info| info.name);
    let list = ComboBox::from_id_salt(egui::Id::unique(salt)).width(100.0);
    let shown = list.selected_text(name(solver.method)).show_ui(ui, |ui| {
        for info in &METHODS {
            ui.selectable_value(&mut solver.method, info.method, info.name).on_hover_text(format!(
                "{}. Solves {} ({}).",
                info.summary, info.solves, info.source
            ));
        }
    });
    let about = || egui::WidgetInfo::labeled(egui::Role::ComboBox, true, "Method");
    shown.response.widget_info(about);
}

fn stop_name(stop: StopTest) -> &'static str {
    STOP_TESTS.iter().find(|(test, ..)| *test == stop).map_or("", |(_, name, _)| name)
}

fn refusal(solver: SolverSettings) -> Option<String> {
    solver.validate().err().map(|error| error.to_string())
}

fn refuse_sweeps(value: f64) -> Option<String> {
    let whole = value.fract() == 0.0 && (1.0..=f64::from(u32::MAX)).contains(&value);
    (!whole).then(|| format!("max-sweeps is {value}, but must be a whole number ≥ 1"))
}

fn refuse_substeps(value: f64) -> Option<String> {
    let whole = value.fract() == 0.0 && (0.0..=f64::from(MAX_SUBSTEPS)).contains(&value);
    let allowed = format!("a whole number, at most {MAX_SUBSTEPS}");
    (!whole).then(|| format!("substeps is {value}, but must be {allowed}"))
}

/// What the last step needed.
fn readings(ui: &mut Ui, state: &AppState) {
    let Some(world) = state.world() else { return };
    let last = &world.snapshot.observables;
    let dark = ui.visuals().dark_mode;
    egui::Grid::new("readings").num_columns(4).spacing([10.0, 3.0]).show(ui, |ui| {
        let reading = |ui: &mut Ui, name: &str, value: String, hint: &str| {
            ui.label(RichText::new(name).weak()).on_hover_text(hint);
            ui.label(RichText::new(value).monospace());
        };
        reading(ui, "sweeps", last.sweeps.to_string(), "Sweeps of the last step.");
        reading(
            ui,
            "residual",
            format!("{:.1e}", last.residual),
            "Common residual of the last step.",
        );
        ui.end_row();
        if world.settings.solver.method == Method::Auto {
            let taken = picked(&world.settings.solver, last.contacts as usize).name();
            reading(ui, "method", taken.to_owned(), "What auto took for the last step.");
            ui.end_row();
        }
        reading(ui, "contacts", last.contacts.to_string(), "Contacts of the last step.");
        reading(ui, "ms/step", format!("{:.2}", world.step_ms), "Mean time of a step, lately.");
        ui.end_row();
        if let MethodKind::Scheme(_) = world.settings.solver.method.kind() {
            let substeps = world.substeps.to_string();
            reading(ui, "substeps", substeps, "Substeps of the next step.");
            let substep_secs = world.settings.parameters.time_step_secs / f64::from(world.substeps);
            reading(ui, "substep", format!("{substep_secs:.1e} s"), "Length of a substep.");
            ui.end_row();
        }
        if let Some(critical_secs) = world.critical_time_step_secs {
            let hint = "Substeps up to this length are surely stable; a little longer, and \
                        crowded grains blow up.";
            reading(ui, "critical", format!("{critical_secs:.1e} s"), hint);
            ui.end_row();
        }
    });
    if let MethodKind::Scheme(_) = world.settings.solver.method.kind() {
        ui.label(RichText::new("a fixed amount of work, no stopping test").weak());
        return;
    }
    let (mark, colour) = if last.converged {
        ("● converged".to_owned(), theme::good(dark))
    } else if last.stalled {
        (
            format!("▲ stalled: residual {:.0e}, more sweeps are of no use", last.residual),
            theme::warning(dark),
        )
    } else {
        (format!("▲ not converged within {} sweeps", last.sweeps), theme::warning(dark))
    };
    ui.label(RichText::new(mark).color(colour));
    if world.unconverged_steps > 0 {
        let text = format!("{} of {} steps did not converge", world.unconverged_steps, last.step);
        ui.label(RichText::new(text).small().color(theme::warning(dark)));
    }
}
