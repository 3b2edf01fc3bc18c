//! Panel: the numbers of the contact law and the time step.

use egui::{RichText, Ui};

use crate::app::number::Number;
use crate::app::state::AppState;
use crate::app::theme;
use crate::contact::range::escape_speed;
use crate::render::numbers::si_prefix;
use crate::solver::SolverSettings;
use crate::world::{ContactLaw, FrictionCone, Parameters};

/// The paper's time steps, s.
pub const PAPER_TIME_STEPS: [f64; 6] = [1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3];

/// Shows the panel.
pub fn show(ui: &mut Ui, state: &mut AppState) {
    let index = state.selected;
    let (Some(wanted), Some(start)) = (state.wanted.get(index), state.frame.start.clone()) else {
        return;
    };
    let before = wanted.parameters;
    let defaults = start.parameters;
    let mut parameters = before;
    let mut places = Vec::new();

    let bond = Number {
        label: "Bond",
        unit: "",
        hint: "Cohesion: how many times its own weight a contact can pull before it opens.",
        range: [0.0, 200.0],
        logarithmic: false,
        default: defaults.bond,
        refuse: &|value| refusal(Parameters { bond: value, ..before }),
    };
    let edited = bond.show(ui, before.bond);
    parameters.bond = edited.value.unwrap_or(parameters.bond);
    places.push(("Bond", edited.slider.rect));
    ui.add_space(4.0);

    let time_step = Number {
        label: "Δt, time step",
        unit: "s",
        hint: "One step of the computation; cohesion cancels the opening speed Bond·g·Δt in each.",
        range: [1e-5, 1e-2],
        logarithmic: true,
        default: defaults.time_step_secs,
        refuse: &|value| refusal(Parameters { time_step_secs: value, ..before }),
    };
    let edited = time_step.show(ui, before.time_step_secs);
    parameters.time_step_secs = edited.value.unwrap_or(parameters.time_step_secs);
    places.push(("Δt", edited.slider.rect));
    time_step_buttons(ui, &mut parameters.time_step_secs);
    ui.add_space(4.0);

    let restitution = Number {
        label: "ρ, restitution",
        unit: "",
        hint: "Part of the approach speed with which grains bounce apart.",
        range: [0.0, 1.0],
        logarithmic: false,
        default: defaults.restitution,
        refuse: &|value| refusal(Parameters { restitution: value, ..before }),
    };
    let edited = restitution.show(ui, before.restitution);
    parameters.restitution = edited.value.unwrap_or(parameters.restitution);
    places.push(("ρ", edited.slider.rect));

    if start.physics.friction {
        let friction = Number {
            label: "μ, friction",
            unit: "",
            hint: "Largest tangential force, in units of the normal force plus cohesion.",
            range: [0.0, 2.0],
            logarithmic: false,
            default: defaults.friction,
            refuse: &|value| refusal(Parameters { friction: value, ..before }),
        };
        let edited = friction.show(ui, before.friction);
        parameters.friction = edited.value.unwrap_or(parameters.friction);
        places.push(("μ", edited.slider.rect));
    }

    if start.physics.cohesion {
        ui.add_space(4.0);
        law_switch(ui, &mut parameters);
        if parameters.law == ContactLaw::Range {
            let distance = Number {
                label: "δc, debonding distance",
                unit: "d",
                hint: "How far a bond is opened before it breaks, in mean diameters.",
                range: [1e-3, 0.1],
                logarithmic: true,
                default: defaults.debonding_distance,
                refuse: &|value| refusal(Parameters { debonding_distance: value, ..before }),
            };
            let edited = distance.show(ui, before.debonding_distance);
            parameters.debonding_distance = edited.value.unwrap_or(parameters.debonding_distance);
            places.push(("δc", edited.slider.rect));
        }
    }

    for (name, rect) in places {
        state.note_control(name, rect);
    }
    if parameters != before {
        state.set_parameters(index, parameters);
        let solver = state.wanted[index].solver;
        let remedies = solver.remedies.under(parameters.law);
        if remedies != solver.remedies {
            state.set_solver(index, SolverSettings { remedies, ..solver });
        }
    }
    ui.add_space(2.0);
    derived(ui, state, &parameters);
}

/// The paper's law or the one under which Bond means the same at every Δt.
fn law_switch(ui: &mut Ui, parameters: &mut Parameters) {
    ui.horizontal(|ui| {
        ui.label("Law");
        let laws = [
            (ContactLaw::Moreau, "moreau", "The paper's: a bond lives while the gap is negative."),
            (ContactLaw::Range, "range", "A bond lives until it is opened by δc, at every Δt."),
        ];
        // The law range knows the shifted cone alone.
        let shifted = parameters.cone == FrictionCone::Shifted;
        for (law, name, hint) in laws {
            ui.add_enabled_ui(shifted || law == ContactLaw::Moreau, |ui| {
                ui.selectable_value(&mut parameters.law, law, name).on_hover_text(hint);
            });
        }
    });
}

fn refusal(parameters: Parameters) -> Option<String> {
    parameters.validate().err().map(|error| error.to_string())
}

/// The paper's six values, one click away.
fn time_step_buttons(ui: &mut Ui, time_step_secs: &mut f64) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        ui.spacing_mut().button_padding.x = 2.0;
        let width = (ui.available_width() - 5.0 * 3.0) / 6.0;
        for value in PAPER_TIME_STEPS {
            let text = RichText::new(format!("{value:e}")).size(11.5);
            let button = egui::Button::selectable(*time_step_secs == value, text)
                .min_size(egui::vec2(width, 19.0));
            if ui.add(button).on_hover_text("A time step of the paper, s").clicked() {
                *time_step_secs = value;
            }
        }
    });
}

/// What the numbers mean together.
fn derived(ui: &mut Ui, state: &AppState, parameters: &Parameters) {
    let Some(world) = state.world() else { return };
    let surroundings = &world.snapshot.surroundings;
    let (diameter, g) = (surroundings.mean_diameter, surroundings.gravity_magnitude);
    let speed = parameters.capture_speed(g);
    let (prefix, factor) = si_prefix(speed);
    let accent = theme::accent(ui.visuals().dark_mode);
    egui::Grid::new("derived").num_columns(2).spacing([8.0, 3.0]).show(ui, |ui| {
        ui.label(RichText::new("cohesive time Bond·Δt/√(d/g)").weak())
            .on_hover_text("What the time step does to cohesion, in one number (paper §3.3).");
        let time = parameters.cohesive_time(diameter, g);
        ui.label(RichText::new(format!("{time:.3}")).color(accent));
        ui.end_row();
        ui.label(RichText::new("capture speed Bond·g·Δt").weak())
            .on_hover_text("The opening speed that one step of cohesion cancels (paper eq. 9).");
        ui.label(RichText::new(format!("{:.3} {prefix}m/s", speed / factor)).color(accent));
        ui.end_row();
        if parameters.law == ContactLaw::Range {
            let distance = parameters.debonding_distance * diameter;
            ui.label(RichText::new("escape speed √(2C₀δc/m_ij)").weak())
                .on_hover_text("A pair that is thrown apart faster parts, at every time step.");
            let escape = escape_speed(parameters.bond, g, distance);
            let (prefix, factor) = si_prefix(escape);
            ui.label(RichText::new(format!("{:.3} {prefix}m/s", escape / factor)).color(accent));
            ui.end_row();
            ui.label(RichText::new("work of a bond C₀δc").weak())
                .on_hover_text("In units of m_ij·g·d: what lifts the pair's mass by a diameter.");
            let work = parameters.bond * parameters.debonding_distance;
            ui.label(RichText::new(format!("{work:.3} m_ij g d")).color(accent));
            ui.end_row();
        }
    });
}
