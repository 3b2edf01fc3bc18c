//! Stepper `moreau`: one step of Contact Dynamics (detect, solve, integrate: Moreau's scheme, as in Abramian & Staron
//! 2020, §2.1), with remedies, which are optional corrections for known failures (`sim::remedies`).

use crate::contact::range::TOUCH_IN_DIAMETERS;
use crate::sim::remedies;
use crate::sim::settings::{Settings, Stepper};
use crate::sim::state::State;
use crate::sim::stepping::{Stage, StepResult};
use crate::sim::touch_tolerance::touch_tolerance;
use crate::sim::turned_bonds;
use crate::solver::{Approach, Model};
use crate::world::Parameters;

pub(super) fn advance<M: Model>(stage: &mut Stage<'_, M>, settings: &Settings) -> StepResult {
    set_up(stage, settings);
    let report = remedies::solve(stage, settings);
    let mut result = stage.move_by(report, settings);
    stage.state.contacts.sum_up();
    remedies::after_step(stage, settings);
    result.turned_bonds = turned_bonds::count(stage, settings);
    result
}

/// Detects the contacts of the next step, and sets up their contact problem.
pub(super) fn set_up<M: Model>(stage: &mut Stage<'_, M>, settings: &Settings) {
    let parameters = settings.parameters;
    let world = stage.world();
    let gravity_magnitude = world.gravity.magnitude();
    let touch = TOUCH_IN_DIAMETERS * world.mean_diameter;
    let tolerance = touch_tolerance(stage.state, settings);
    let touching = touching_within(stage.state, tolerance);
    let rebound = |Approach { velocity, gap, in_touch, restitution }| {
        if !in_touch && settings.stepper == Stepper::Moreau {
            // A pair that is not in touch yet may close its gap and a little more. So it touches at the end of the
            // step, and the next step finds the contact.
            return (gap + touch) / parameters.time_step_secs;
        }
        let restitution = restitution.unwrap_or(parameters.restitution);
        let rebound = Parameters { restitution, ..parameters }
            .restitution_velocity(velocity, gravity_magnitude);
        if !in_touch || tolerance > 0.0 && gap > touching {
            // A pair that touches only by the tolerance or ahead bounces if it closes its gap within the step.
            let meets = rebound < 0.0 && gap + parameters.time_step_secs * velocity < 0.0;
            return if meets { rebound } else { gap / parameters.time_step_secs };
        }
        rebound
    };
    if settings.remedies.speculative {
        let ahead = |state: &_| {
            let ahead = remedies::look_ahead(state, parameters.time_step_secs);
            Some(if tolerance > 0.0 { ahead.pulling_within(tolerance) } else { ahead })
        };
        stage.prepare_ahead(settings, ahead, rebound);
    } else if tolerance > 0.0 {
        stage.prepare_within(settings, tolerance, rebound);
    } else {
        stage.prepare(settings, rebound);
    }
    if settings.remedies.turning_bonds {
        remedies::let_turn(stage, parameters.time_step_secs);
    }
}

/// Returns the gap, m, up to which a contact counts as closed, so that its grains may not approach each other any more.
/// Contacts with larger gaps, up to `tolerance` (m), pull too, but their grains may close the gap.
fn touching_within(state: &State, tolerance: f64) -> f64 {
    let rounding = (0.5 * tolerance).min(TOUCH_IN_DIAMETERS * state.world.mean_diameter);
    rounding.max(state.candidates.gap_tolerance())
}
