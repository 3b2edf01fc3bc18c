//! Remedies: optional corrections for known failures of a stepper, as functions that steppers and the simulation call.
//! Their registry is `sim::settings::remedy`.

#![deny(dead_code, reason = "a remedy that no step calls would not be missed")]

mod look_ahead;
mod pieces;
mod push_out;
pub(super) mod sequential_impacts;

pub(super) use look_ahead::look_ahead;
pub(super) use pieces::pieces;

use crate::sim::settings::Settings;
use crate::sim::stepping::Stage;
use crate::solver::{Model, SolveReport};

/// Solves the prepared contact problem of a step, with the remedy `sequential-impacts` if the settings turn it on.
pub(super) fn solve<M: Model>(stage: &mut Stage<'_, M>, settings: &Settings) -> SolveReport {
    if settings.remedies.sequential_impacts {
        sequential_impacts::solve(stage, settings)
    } else {
        stage.solve(settings)
    }
}

/// Corrects positions after the grains have moved, with the remedy `push-out` if the settings turn it on.
pub(super) fn after_step<M: Model>(stage: &mut Stage<'_, M>, settings: &Settings) {
    if settings.remedies.push_out {
        push_out::push_out(stage.state, settings.parameters.time_step_secs);
    }
}
