//! The ways to take a step of Δt, each with its own contact law: the registry. A way to step is a file or
//! folder here with its `INFO` and its `advance`, a word of [`Stepper`], and an arm of each match below.

#![deny(dead_code, reason = "a way to step that no row names would not be missed")]

mod avbd;
mod course;
mod dem;
mod info;
mod mean_pair;
pub(super) mod moreau;
mod range;
pub(super) mod stepper;
mod tgs_soft;
mod touching;

use serde::{Deserialize, Serialize};

pub use dem::SpringDashpot;
pub use info::StepperInfo;
pub use mean_pair::FractureWork;
pub use stepper::Stepper;

use super::settings::Settings;
use super::stepping::{Advance, Outcome, Stage};
use crate::solver::Model;

impl Stepper {
    /// What there is to know of it.
    pub const fn info(self) -> &'static StepperInfo {
        match self {
            Self::Moreau => &moreau::INFO,
            Self::Range => &range::INFO,
            Self::TgsSoft => &tgs_soft::INFO,
            Self::Avbd => &avbd::INFO,
            Self::Dem => &dem::INFO,
        }
    }

    /// Whether it reads the setting of that name.
    pub fn reads(self, name: &str) -> bool {
        self.info().settings.contains(&name)
    }

    /// Whether it solves the step's problem by one of the methods.
    pub fn uses_method(self) -> bool {
        self.reads("solver")
    }

    /// Whether it tells of bonds.
    pub(super) fn has_bonds(self) -> bool {
        self.info().observables.contains(&"bond_energy")
    }
}

/// What ways to step remember from one step to the next.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Memory {
    range: range::Memory,
}

impl Advance for Memory {
    fn advance<M: Model>(&mut self, stage: &mut Stage<'_, M>, settings: &Settings) -> Outcome {
        match settings.stepper {
            Stepper::Moreau => moreau::advance(stage, settings),
            Stepper::Range => range::advance(stage, settings, &mut self.range),
            Stepper::TgsSoft => tgs_soft::advance(stage, settings),
            Stepper::Avbd => avbd::advance(stage, settings),
            Stepper::Dem => dem::advance(stage, settings),
        }
    }
}

impl Memory {
    /// Where a step since the last call was too long for the bonds that were about to break in it: the longest
    /// that is not, s.
    pub(super) fn take_longest_step_secs(&mut self) -> Option<f64> {
        self.range.longest_step_secs.take()
    }

    /// Detects the contacts of the next step and sets up its problem, as it is before any solution.
    pub(super) fn prepare<M: Model>(&self, stage: &mut Stage<'_, M>, settings: &Settings) {
        match settings.stepper {
            Stepper::Range => range::prepare(stage, settings),
            Stepper::Moreau | Stepper::TgsSoft | Stepper::Avbd | Stepper::Dem => {
                moreau::set_up(stage, settings);
            }
        }
    }

    /// Sets up the first problem that the method gets in the next step; where no method gets any, the
    /// problem that the step is judged by.
    #[inline(never)]
    pub(super) fn set_up<M: Model>(&mut self, stage: &mut Stage<'_, M>, settings: &Settings) {
        match settings.stepper {
            Stepper::Moreau => moreau::set_up_with_impacts(stage, settings),
            Stepper::Range => range::set_up(stage, settings, &mut self.range),
            Stepper::TgsSoft | Stepper::Avbd | Stepper::Dem => moreau::set_up(stage, settings),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steppers_read_settings_that_exist_and_every_setting_is_read_by_one() {
        let remedies = |name: &str| crate::sim::remedies::ROWS.iter().any(|row| row.name == name);
        let names: Vec<&str> = Settings::about().map(|about| about.name).collect();
        for stepper in Stepper::ALL {
            for name in stepper.info().settings {
                assert!(names.contains(name), "{stepper} reads {name}");
            }
        }
        for name in names {
            let read = Stepper::ALL.iter().any(|stepper| stepper.reads(name));
            assert!(read || remedies(name) || name == "stepper", "{name}");
        }
    }
}
