//! Remedies for known failures, as hooks that steppers and the simulation call. `sim::settings::remedy` is their registry.

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

/// Solves the prepared problem.
pub(super) fn solve<M: Model>(stage: &mut Stage<'_, M>, settings: &Settings) -> SolveReport {
    if settings.remedies.sequential_impacts {
        sequential_impacts::solve(stage, settings)
    } else {
        stage.solve(settings)
    }
}

/// Corrects positions once the grains have moved.
pub(super) fn after_step<M: Model>(stage: &mut Stage<'_, M>, settings: &Settings) {
    if settings.remedies.push_out {
        push_out::push_out(stage.state, settings.parameters.time_step_secs);
    }
}
