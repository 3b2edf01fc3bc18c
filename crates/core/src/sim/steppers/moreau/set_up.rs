//! The problem of a step under the paper's law.

use crate::contact::range::TOUCH_IN_DIAMETERS;
use crate::sim::remedies::speculative;
use crate::sim::settings::Settings;
use crate::sim::stepping::Stage;
use crate::solver::{Approach, Model};

/// Detects the contacts and sets up the problem of the next step.
pub(in crate::sim) fn set_up<M: Model>(stage: &mut Stage<'_, M>, settings: &Settings) {
    let parameters = settings.parameters;
    let world = stage.world();
    let gravity_magnitude = world.gravity.magnitude();
    let touch = TOUCH_IN_DIAMETERS * world.mean_diameter;
    let rebound = |Approach { velocity, gap, in_touch }| {
        if in_touch {
            return parameters.restitution_velocity(velocity, gravity_magnitude);
        }
        // It lands in touch, so that the next step knows it.
        (gap + touch) / parameters.time_step_secs
    };
    if settings.remedies.speculative {
        let ahead = |state: &_| Some(speculative::look_ahead(state, parameters.time_step_secs));
        stage.prepare_ahead(settings, ahead, rebound);
    } else {
        stage.prepare(settings, rebound);
    }
}
