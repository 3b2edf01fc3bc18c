//! One step of Contact Dynamics: detect, solve, integrate (paper §2.1, scheme of Moreau), with what remedies
//! make of it.

use crate::contact::range::TOUCH_IN_DIAMETERS;
use crate::sim::remedies;
use crate::sim::settings::Settings;
use crate::sim::steppers::StepperInfo;
use crate::sim::stepping::{Stage, StepResult};
use crate::sim::turned_bonds;
use crate::solver::{Approach, Model};

pub(super) const INFO: StepperInfo = StepperInfo {
    solves: "each step's problem under Signorini's law with cohesion and Coulomb's law",
    source: "A. Abramian, L. Staron, Time Steps v.s. Cohesion (2020); J. J. Moreau (1988)",
    settings: "bond bond-acceleration dt tilt rho mu cone restitution-threshold solver ordering stop tolerance \
        max-sweeps warm-start friction-model model-solves",
    takes_drives: true,
    ..StepperInfo::WHOLE
};

pub(super) fn advance<M: Model>(stage: &mut Stage<'_, M>, settings: &Settings) -> StepResult {
    set_up(stage, settings);
    let report = remedies::solve(stage, settings);
    let mut result = stage.move_by(report, settings);
    stage.state.contacts.sum_up();
    remedies::after_step(stage, settings);
    result.turned_bonds = turned_bonds::count(stage, settings.parameters.time_step_secs);
    result
}

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
        let ahead = |state: &_| Some(remedies::look_ahead(state, parameters.time_step_secs));
        stage.prepare_ahead(settings, ahead, rebound);
    } else {
        stage.prepare(settings, rebound);
    }
}
