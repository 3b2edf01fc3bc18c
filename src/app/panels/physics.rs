//! Panel: the stepper with its contact law, the numbers that are not at the front, and what all of them mean together.

use egui::{RichText, Ui};
use glam::DVec2;

use super::front::FRONT_SETTINGS;
use super::grain::{compact, si};
use crate::app::state::AppState;
use crate::app::{setting_control, theme};
use crate::contact::range::escape_speed;
use crate::setting::{About, Group, Needs};
use crate::sim::{Settings, Stepper};
use crate::world::Parameters;

pub(crate) fn show(ui: &mut Ui, state: &mut AppState) {
    let index = state.selected;
    let (Some(wanted), Some(start)) = (state.wanted.get(index), state.frame.start.clone()) else {
        return;
    };
    let before = wanted.settings;
    let mut settings = before;
    stepper_switch(ui, &mut settings);
    for about in shown_settings(state, &before) {
        if FRONT_SETTINGS.contains(&about.name) {
            continue;
        }
        setting_control::show(ui, about, &mut settings, start.settings());
        ui.add_space(2.0);
    }
    if settings != before {
        state.change(index, settings);
    }
    derived(ui, state, &settings);
}

/// The settings of the law and the time step that mean something to the scene and that the stepper reads.
pub(super) fn shown_settings(state: &AppState, settings: &Settings) -> Vec<&'static About> {
    let Some(physics) = state.frame.start.as_ref().map(|start| start.physics()) else {
        return Vec::new();
    };
    let gravity = state.world().and_then(|world| world.gravity);
    let has_direction = physics.axes == 2 && gravity.is_some_and(|gravity| gravity != DVec2::ZERO);
    let is_shown = |about: &&About| {
        let has = match about.needs {
            Needs::Nothing => true,
            Needs::Friction => physics.friction,
            Needs::Cohesion => physics.cohesion,
            Needs::Direction => has_direction,
        };
        has && about.control.is_some() && settings.stepper.reads(about.name)
    };
    Parameters::ABOUT.iter().filter(is_shown).collect()
}

/// The ways to step; remedies that the chosen one does not take are left out.
fn stepper_switch(ui: &mut Ui, settings: &mut Settings) {
    let before = settings.stepper;
    ui.horizontal(|ui| {
        ui.label("Stepper").on_hover_text("The way to step, with its contact law.");
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

/// What the numbers mean together.
fn derived(ui: &mut Ui, state: &AppState, settings: &Settings) {
    let parameters = &settings.parameters;
    let Some(world) = state.world() else { return };
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
            "What the time step does to cohesion, in one number (paper §3.3).",
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
                "A pair that is thrown apart faster parts, at every time step.",
                si(
                    escape_speed(parameters.bond, parameters.cohesion_acceleration(g), distance),
                    "m/s",
                ),
            );
        }
        if let Some(secs) = world.contact_time_secs {
            let hint = "How long two grains of the mean mass push each other that meet.";
            row("contact time t_c", hint, si(secs, "s"));
        }
        if let Some(work) = world.fracture_work {
            row(
                "work of fracture",
                "What it takes to break the bond of two grains of the mean mass m slowly: C₀δc under range, C₀²/2k \
                 under dem. m·g·d lifts one of them by a diameter.",
                format!("{} = {:.1e} m g d", si(work.joules, "J"), work.over_mgd),
            );
        }
    });
}
