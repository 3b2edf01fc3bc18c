//! Remedies: optional corrections for known failures of a stepper. Each remedy is a function that steppers or the
//! simulation call. The list of all remedies is in `sim::settings::remedy`.

#![deny(dead_code, reason = "a remedy that no step calls would not be missed")]

mod look_ahead;
mod pieces;
mod push_out;
pub(super) mod sequential_impacts;
mod turning_bonds;

pub(super) use look_ahead::look_ahead;
pub(super) use pieces::pieces;
pub(super) use turning_bonds::let_turn;

use crate::sim::settings::Settings;
use crate::sim::stepping::Stage;
use crate::solver::{Model, SolveReport};

/// Solves the contact problem of a step after it has been set up. If the settings turn on the remedy (optional
/// correction) `sequential-impacts`, this includes its computation of shocks (collisions).
pub(super) fn solve<M: Model>(stage: &mut Stage<'_, M>, settings: &Settings) -> SolveReport {
    if settings.remedies.sequential_impacts {
        sequential_impacts::solve(stage, settings)
    } else {
        stage.solve(settings)
    }
}

/// Pushes overlapping grains apart after the grains have moved, if the settings turn on the remedy (optional
/// correction) `push-out`.
pub(super) fn after_step<M: Model>(stage: &mut Stage<'_, M>, settings: &Settings) {
    if settings.remedies.push_out {
        push_out::push_out(stage.state, settings.parameters.time_step_secs);
    }
}
