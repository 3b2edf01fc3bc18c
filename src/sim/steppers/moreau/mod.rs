//! One step of Contact Dynamics: detect, solve, integrate (paper §2.1, scheme of Moreau), with what remedies
//! make of it.

pub(in crate::sim) mod set_up;

pub(super) use self::set_up::set_up;

use super::StepperInfo;
use crate::sim::remedies::{calm_unsolved, push_out, sequential_impacts};
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
    ],
    ..StepperInfo::WHOLE
};

/// Takes one step.
pub(super) fn advance<M: Model>(stage: &mut Stage<'_, M>, settings: &Settings) -> Outcome {
    set_up(stage, settings);
    let report = if settings.remedies.sequential_impacts {
        sequential_impacts::solve(stage, settings)
    } else {
        stage.solve(settings)
    };
    let report = if settings.remedies.calm_unsolved && !report.converged {
        calm_unsolved::solve_again(stage, settings, report)
    } else {
        report
    };
    let outcome = stage.move_by(report, settings);
    if settings.remedies.push_out {
        push_out::push_out(stage.state, settings.parameters.time_step_secs);
    }
    outcome
}

/// Sets up the problem as its method gets it.
pub(super) fn set_up_with_impacts<M: Model>(stage: &mut Stage<'_, M>, settings: &Settings) {
    set_up(stage, settings);
    if settings.remedies.sequential_impacts {
        sequential_impacts::follow(stage, settings);
    }
}
