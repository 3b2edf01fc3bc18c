//! Steppers: the rules that advance the grains by one time step, each with its own contact law. For each stepper this
//! folder has a file or a folder with a function `advance`. A stepper also has a match arm in
//! [`StepperMemory::advance`], and a row in the list of steppers `sim::settings::stepper`.

#![deny(dead_code, reason = "a stepper that no arm calls would not be missed")]

mod avbd;
mod dem;
mod moreau;
mod range;
mod substeps;
mod tgs_soft;

use serde::{Deserialize, Serialize};

use crate::sim::remedies::sequential_impacts;
use crate::sim::settings::{Settings, Stepper};
use crate::sim::stepping::{Advance, Stage, StepResult};
use crate::solver::Model;

/// Data that steppers keep from one step to the next.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct StepperMemory {
    pub range: range::RangeMemory,
}

impl Advance for StepperMemory {
    fn advance<M: Model>(&mut self, stage: &mut Stage<'_, M>, settings: &Settings) -> StepResult {
        match settings.stepper {
            Stepper::Moreau => moreau::advance(stage, settings),
            Stepper::Range => range::advance(stage, settings, &mut self.range),
            Stepper::TgsSoft => tgs_soft::advance(stage, settings),
            Stepper::Avbd => avbd::advance(stage, settings),
            Stepper::Dem => dem::advance(stage, settings),
        }
    }
}

impl StepperMemory {
    /// Detects the contacts of the next step and sets up its contact problem, without solving anything.
    pub(super) fn prepare<M: Model>(&self, stage: &mut Stage<'_, M>, settings: &Settings) {
        match settings.stepper {
            Stepper::Range => range::prepare(stage, settings),
            _ => moreau::set_up(stage, settings),
        }
    }

    /// Sets up the first contact problem that the solver receives in the next step. For steppers without a solver, sets
    /// up the problem from which the residual of the step is computed.
    #[inline(never)]
    pub(super) fn set_up<M: Model>(&mut self, stage: &mut Stage<'_, M>, settings: &Settings) {
        match settings.stepper {
            Stepper::Range => range::set_up(stage, settings, &mut self.range),
            _ => moreau::set_up(stage, settings),
        }
        if settings.stepper == Stepper::Moreau && settings.remedies.sequential_impacts {
            sequential_impacts::follow(stage, settings);
        }
    }
}
