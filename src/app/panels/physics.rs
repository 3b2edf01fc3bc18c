//! Panel: the stepper (rule that advances the grains by Δt) with its contact law, the parameters without a main slider
//! (all except Bond, Δt, ρ and μ), and quantities derived from the parameters.

use egui::{RichText, Ui};

use super::grain::{compact, si};
use super::shown_settings::{FRONT_SETTINGS, shown_settings};
use crate::app::watched_run::WatchedRun;
use crate::app::{setting_control, theme};
use crate::contact::range::escape_speed;
use crate::number::millis_text;
use crate::sim::{Settings, Stepper};

pub(super) fn show(ui: &mut Ui, run: &WatchedRun, settings: &mut Settings, start: &Settings) {
    let controls = shown_settings(run, settings);
    stepper_switch(ui, settings);
    for about in controls.into_iter().filter(|about| !FRONT_SETTINGS.contains(&about.name)) {
        setting_control::show(ui, about, settings, start);
        ui.add_space(2.0);
    }
    derived(ui, run, settings);
}

/// Shows the buttons that choose the stepper (rule that advances the grains by Δt). Remedies (corrections of known
/// weaknesses of a step) that the new stepper does not support are switched off.
fn stepper_switch(ui: &mut Ui, settings: &mut Settings) {
    let before = settings.stepper;
    ui.horizontal(|ui| {
        ui.label("Stepper")
            .on_hover_text("The rule that advances the grains by Δt, with its contact law.");
        ui.spacing_mut().item_spacing.x = 2.0;
        ui.spacing_mut().button_padding.x = 5.0;
        for &stepper in Stepper::ALL {
            let info = stepper.info();
            let refused = (info.check)(&settings.parameters).err().map(|why| why.to_string());
            let hint = format!("{}. Solves {} ({}).", stepper.hint(), info.solves, info.source);
            ui.add_enabled_ui(refused.is_none(), |ui| {
                ui.selectable_value(&mut settings.stepper, stepper, stepper.name())
                    .on_hover_text(hint)
                    .on_disabled_hover_text(refused.unwrap_or_default());
            });
        }
    });
    if settings.stepper != before {
        *settings = settings.with_only_what_is_taken();
    }
}

/// Shows quantities that are derived from the parameters, such as the cohesive time Bond·Δt/√(d/g), a dimensionless
/// number (Δt: time step, s; d: mean diameter, m; g: gravity, m/s²).
fn derived(ui: &mut Ui, run: &WatchedRun, settings: &Settings) {
    let parameters = &settings.parameters;
    let Some(world) = run.world() else { return };
    let surroundings = &world.snapshot.surroundings;
    let (diameter, g) = (surroundings.mean_diameter, surroundings.gravity_magnitude);
    let accent = theme::accent(ui.visuals().dark_mode);
    egui::Grid::new("derived").num_columns(2).spacing([8.0, 3.0]).show(ui, |ui| {
        let mut row = |name: &str, hint: &str, value: String| {
            ui.label(RichText::new(name).weak()).on_hover_text(hint);
            ui.label(RichText::new(value).color(accent));
            ui.end_row();
        };
        row(
            "cohesive time Bond·Δt/√(d/g)",
            "The effect of the time step on cohesion, in one number (paper §3.3).",
            compact(parameters.cohesive_time(diameter, g)),
        );
        row(
            "capture speed Bond·g·Δt",
            "The opening speed that one step of cohesion cancels (paper eq. 9).",
            si(parameters.capture_speed(g), "m/s"),
        );
        if settings.stepper.reads("debonding-distance") {
            let distance = parameters.debonding_distance * diameter;
            row(
                "escape speed √(2C₀δc/m_ij)",
                "A pair that separates faster than this parts, at every time step.",
                si(
                    escape_speed(parameters.bond, parameters.cohesion_acceleration(g), distance),
                    "m/s",
                ),
            );
        }
        if let Some(secs) = world.contact_time_secs {
            let hint = "Duration of a collision of two grains of the mean mass.";
            row("contact time t_c", hint, millis_text(secs));
        }
        if let Some(work) = world.fracture_work {
            row(
                "work of fracture",
                "Work of breaking the bond of two grains of the mean mass m slowly: C₀δc under range, C₀²/2k under \
                 dem. m·g·d lifts one of them by a diameter.",
                format!("{} = {:.1e} m g d", si(work.joules, "J"), work.over_mgd),
            );
        }
    });
}
