//! One step of Contact Dynamics: detect, solve, integrate (paper §2.1, scheme of Moreau), with what remedies
//! make of it.

pub(in crate::sim) mod set_up;

pub(super) use self::set_up::set_up;

use super::StepperInfo;
use crate::sim::remedies::{self, sequential_impacts};
use crate::sim::settings::Settings;
use crate::sim::stepping::{Outcome, Stage};
use crate::solver::Model;

/// The row of the registry.
pub(super) const INFO: StepperInfo = StepperInfo {
    solves: "each step's problem under Signorini's law with cohesion and Coulomb's law",
    source: "A. Abramian, L. Staron, Time Steps v.s. Cohesion (2020); J. J. Moreau (1988)",
    settings: &[
        "bond",
        "dt",
        "tilt",
        "rho",
        "mu",
        "cone",
        "restitution-threshold",
        "solver",
        "ordering",
        "stop",
        "tolerance",
        "max-sweeps",
        "warm-start",
        "friction-model",
        "model-solves",
        "fallback",
        "islands",
    ],
    takes_drives: true,
    ..StepperInfo::WHOLE
};

/// Takes one step.
pub(super) fn advance<M: Model>(stage: &mut Stage<'_, M>, settings: &Settings) -> Outcome {
    set_up(stage, settings);
    let report = remedies::solve(stage, settings);
    let outcome = stage.move_by(report, settings);
    remedies::after_step(stage, settings);
    outcome
}

/// Sets up the problem as its method gets it.
pub(super) fn set_up_with_impacts<M: Model>(stage: &mut Stage<'_, M>, settings: &Settings) {
    set_up(stage, settings);
    if settings.remedies.sequential_impacts {
        sequential_impacts::follow(stage, settings);
    }
}
