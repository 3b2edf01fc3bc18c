//! Panel: the solver, and the result of the last step.

use egui::{Button, RichText, Ui};

use super::grain::compact;
use crate::app::budget::BUDGETS;
use crate::app::watched_run::WatchedRun;
use crate::app::{setting_control, theme};
use crate::live::{LiveStart, WorldFrame};
use crate::number::millis_text;
use crate::scene::Preset;
use crate::setting::{About, Control, Group};
use crate::sim::{Observables, REMEDIES, Remedies, Settings, Surroundings};
use crate::solver::{Method, SolverSettings, StopTest};

pub(super) fn show(ui: &mut Ui, run: &WatchedRun, settings: &mut Settings) {
    if let Some(world) = run.world().filter(|_| settings.stepper.uses_method()) {
        budget_buttons(ui, settings, &world.snapshot.surroundings);
    }
    readings(ui, run);
}

/// Shows the controls for the expert settings of the solver, which few users need: method, warm start, friction model,
/// and remedies (corrections of known weaknesses of a step).
pub(super) fn expert(ui: &mut Ui, settings: &mut Settings, start: &LiveStart) {
    let (stepper, has_friction, start) =
        (settings.stepper, start.physics().friction, start.settings());
    if stepper.uses_method() {
        method_controls(ui, settings, start);
    }
    if stepper.reads("warm-start") {
        setting_control::show(ui, about("warm-start"), settings, start);
    }
    if stepper.reads("friction-model") && has_friction {
        friction_controls(ui, settings, start);
    }
    if stepper.uses_method() {
        remedy_boxes(ui, settings, start);
    }
}

/// Returns the declaration (name, range, help text) of a setting of the solver.
fn about(name: &str) -> &'static About {
    let found = SolverSettings::ABOUT.iter().find(|about| about.name == name);
    found.unwrap_or(&SolverSettings::ABOUT[0])
}

/// Shows the controls for the solver, its stopping criterion, its tolerance and its largest number of sweeps. If the
/// chosen solver does not support the friction model, the friction model is replaced.
fn method_controls(ui: &mut Ui, settings: &mut Settings, start: &Settings) {
    egui::Grid::new("solver").num_columns(2).spacing([8.0, 5.0]).show(ui, |ui| {
        let before = settings.solver;
        setting_control::show(ui, about("solver"), settings, start);
        if settings.solver.method != before.method {
            settings.solver = before.by(settings.solver.method);
        }
        ui.end_row();
        if settings.solver.method.sweeps_in_order() {
            setting_control::show(ui, about("ordering"), settings, start);
            ui.end_row();
        }
        setting_control::show(ui, about("stop"), settings, start);
        ui.end_row();
    });
    let tolerance = about("tolerance");
    if let Some(control) = tolerance.control {
        let unit = match settings.solver.stop {
            StopTest::ImpulsePerMass => "m/s",
            StopTest::VelocityError => "√(g d)",
            StopTest::RelativeChange | StopTest::Residual => "",
        };
        let control = Control { unit, ..control };
        setting_control::show_as(ui, tolerance, &control, settings, start);
    }
    setting_control::show(ui, about("max-sweeps"), settings, start);
}

/// Shows the list from which the user chooses the friction model. The list is disabled for a solver that solves only
/// Coulomb friction.
fn friction_controls(ui: &mut Ui, settings: &mut Settings, start: &Settings) {
    let method = settings.solver.method.info();
    let model = about("friction-model");
    ui.add_enabled_ui(method.takes_models, |ui| {
        ui.horizontal(|ui| setting_control::show(ui, model, settings, start));
    })
    .response
    .on_disabled_hover_text(format!("{} solves only Coulomb friction.", method.name));
    if settings.solver.friction_model.is_taken_anew() {
        setting_control::show(ui, about("model-solves"), settings, start);
    }
}

/// Shows the switches of the remedies (corrections of known weaknesses of a step). Remedies that the stepper does not
/// support are disabled.
fn remedy_boxes(ui: &mut Ui, settings: &mut Settings, start: &Settings) {
    let all = Remedies::ABOUT.iter().zip(&REMEDIES);
    for (about, remedy) in all.filter(|(about, _)| about.control.is_some()) {
        let taken = remedy.taken_by.contains(&settings.stepper);
        ui.add_enabled_ui(taken, |ui| setting_control::show(ui, about, settings, start))
            .response
            .on_disabled_hover_text(format!("The stepper {} does not take it.", settings.stepper));
    }
}

/// Shows the buttons of the solver presets.
fn budget_buttons(ui: &mut Ui, settings: &mut Settings, surroundings: &Surroundings) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        let before = *settings;
        let mut button = |name: &str, preset: Settings, hint: &str| {
            let button = Button::selectable(before == preset, name).frame_when_inactive(true);
            if ui.add(button).on_hover_text(hint).clicked() {
                *settings = preset;
            }
        };
        for effort in BUDGETS {
            let solver = effort.among(surroundings, &before.parameters);
            button(effort.name, Settings { solver, ..before }, effort.hint);
        }
        let mut robust = before;
        Preset::Robust.apply_to_settings(&mut robust);
        button(
            "Robust",
            robust,
            "Newton to 1e-8. Overlap is pushed out, shocks are solved in sequence, nothing bounces below 2 g Δt, \
             and fast grains move in parts of a step. Hard scenes hold, and the paper's effects of Δt disappear.",
        );
    });
}

/// Shows measured values of the last step, such as the numbers of sweeps and contacts and the residual.
fn readings(ui: &mut Ui, run: &WatchedRun) {
    let Some(world) = run.world() else { return };
    let (last, settings) = (&world.snapshot.observables, &world.controls.settings);
    egui::Grid::new("readings").num_columns(4).spacing([10.0, 3.0]).show(ui, |ui| {
        let reading = |ui: &mut Ui, name: &str, value: String, hint: &str| {
            ui.label(RichText::new(name).weak()).on_hover_text(hint);
            ui.label(RichText::new(value).monospace());
        };
        reading(ui, "sweeps", last.sweeps.to_string(), "Sweeps of the last step.");
        let residual = format!("{:.1e}", last.residual);
        reading(ui, "residual", residual, "Common residual of the last step.");
        ui.end_row();
        if settings.solver.method == Method::Auto {
            let taken = world.picked_method.name();
            reading(ui, "solver", taken.to_owned(), "The solver that auto chose for the last step.");
            ui.end_row();
        }
        reading(ui, "contacts", last.contacts.to_string(), "Contacts of the last step.");
        reading(ui, "ms/step", format!("{:.2}", world.step_ms), "Recent mean time per step.");
        ui.end_row();
        if settings.stepper.reads("substeps") {
            let substeps = world.substeps.to_string();
            reading(ui, "substeps", substeps, "Substeps of the next step.");
            let substep_secs = settings.parameters.time_step_secs / f64::from(world.substeps);
            reading(ui, "substep", millis_text(substep_secs), "Length of a substep.");
            ui.end_row();
        }
        if let Some(critical_secs) = world.critical_time_step_secs {
            let hint = "Longest substep that is certainly stable. With slightly longer substeps crowded grains \
                        blow up.";
            reading(ui, "critical", millis_text(critical_secs), hint);
            ui.end_row();
        }
    });
    if settings.stepper.uses_method() {
        solved(ui, world);
    } else {
        ui.label(RichText::new("a fixed amount of work, no stopping test").weak());
    }
}

/// Returns the text of the estimated velocity error of a step, rounded up.
fn within(last: &Observables) -> String {
    let rounded_up = (1e5 * last.velocity_error).ceil().max(1.0) / 100.0;
    format!("velocity error about {} mm/s", compact(rounded_up))
}

/// Shows whether the last step reached the tolerance of the solver, and its estimated velocity error.
fn solved(ui: &mut Ui, world: &WorldFrame) {
    let last = &world.snapshot.observables;
    let dark = ui.visuals().dark_mode;
    let (mut mark, mut colour) = (String::new(), theme::warning(dark));
    if last.step == 0 {
        (mark, colour) = ("○ no step yet".into(), ui.visuals().weak_text_color());
    } else if last.converged {
        (mark, colour) = (format!("● converged, {}", within(last)), theme::good(dark));
    } else if last.stalled {
        mark += &format!("▲ stalled: residual {:.0e}, more sweeps do not help", last.residual);
    } else {
        mark += &format!("▲ not converged within {} sweeps, {}", last.sweeps, within(last));
    }
    ui.label(RichText::new(mark).color(colour));
}
