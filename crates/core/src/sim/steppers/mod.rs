//! The ways to take a step of Δt, each with its own contact law: the registry. A way to step is a file or
//! folder here with its `INFO` and its `advance`, a word of [`Stepper`], and an arm of each match below.

#![deny(dead_code, reason = "a way to step that no row names would not be missed")]

mod avbd;
mod dem;
pub(super) mod moreau;
mod range;
mod spring_dashpot;
mod substeps;
mod tgs_soft;

pub use spring_dashpot::SpringDashpot;
pub(super) use spring_dashpot::stable_substeps;

use serde::{Deserialize, Serialize};

use crate::contact::law::cohesion_force;
use crate::error::Result;
use crate::setting::words;
use crate::sim::remedies::sequential_impacts;
use crate::sim::settings::Settings;
use crate::sim::stepping::{Advance, Stage, StepResult};
use crate::solver::Model;
use crate::world::{Parameters, Physics, World};

words! {
    /// A way to take a step of Δt, with its contact law.
    #[derive(Default)]
    pub enum Stepper {
        #[default]
        Moreau = "moreau", "the paper's law: a contact and its bond live while the gap is negative";
        Range = "range", "a bond lives until it has been opened by δc, whatever Δt";
        TgsSoft = "tgs-soft",
            "substeps with soft contacts and a relaxing sweep, as game engines step";
        Avbd = "avbd", "augmented vertex block descent: stiffening penalties, body by body, as game engines try";
        Dem = "dem", "smooth discrete elements: springs, dashpots and a constant attraction";
    }
}

/// What there is to know of a way to step, beside its name and its line.
#[derive(Clone, Copy, Debug)]
pub struct StepperInfo {
    /// What a step of it solves, one line.
    pub solves: &'static str,
    /// Where it comes from.
    pub source: &'static str,
    /// The settings that it reads, by name, with spaces between. With `solver` among them it solves the step's problem
    /// by a method.
    pub settings: &'static str,
    /// Observables that it has beside those that all have.
    pub observables: &'static [&'static str],
    /// True where it moves walls that a force drives.
    pub takes_drives: bool,
    /// Refuses numbers that do not go with it.
    pub check: fn(&Parameters) -> Result<()>,
    /// Refuses numbers that do not go with it in a world.
    pub check_in: fn(&World, Physics, &Parameters) -> Result<()>,
    /// Substeps of a step; 1 where its problem is solved as a whole.
    pub substeps: fn(&World, Physics, &Parameters) -> u32,
    /// The longest substep, s, that is stable whatever the grains do; none where that is no question.
    pub critical_time_step_secs: fn(&World, Physics, &Parameters) -> Option<f64>,
    /// How long two grains of the mean mass that meet push each other, s; none where that is no time.
    pub contact_time_secs: fn(&World, Physics, &Parameters) -> Option<f64>,
    /// What it takes to break a bond slowly; none where the law does not say, or the physics has no cohesion.
    pub fracture_work: fn(&World, Physics, &Parameters) -> Option<FractureWork>,
}

impl StepperInfo {
    /// One that solves the problem of the step as a whole.
    pub(super) const WHOLE: Self = Self {
        solves: "",
        source: "",
        settings: "",
        observables: &[],
        takes_drives: false,
        check: |_| Ok(()),
        check_in: |_, _, _| Ok(()),
        substeps: |_, _, _| 1,
        critical_time_step_secs: |_, _, _| None,
        contact_time_secs: |_, _, _| None,
        fracture_work: |_, _, _| None,
    };
}

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

    /// True where it reads the setting of that name.
    pub fn reads(self, name: &str) -> bool {
        self.info().settings.split(' ').any(|setting| setting == name)
    }

    /// True where it solves the step's problem by one of the methods.
    pub fn uses_method(self) -> bool {
        self.reads("solver")
    }

    /// True where it tells of bonds.
    pub(super) fn has_bonds(self) -> bool {
        self.info().observables.contains(&"bond_energy")
    }
}

/// What ways to step remember from one step to the next.
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
    /// Detects the contacts of the next step and sets up its problem, as it is before any solution.
    pub(super) fn prepare<M: Model>(&self, stage: &mut Stage<'_, M>, settings: &Settings) {
        match settings.stepper {
            Stepper::Range => range::prepare(stage, settings),
            _ => moreau::set_up(stage, settings),
        }
    }

    /// Sets up the first problem that the method gets in the next step; where no method gets any, the
    /// problem that the step is judged by.
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

/// The work that slowly parts two bonded grains of the mean mass m.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FractureWork {
    /// J.
    pub joules: f64,
    /// In m·g·d, which lifts one of the grains by a diameter. Without gravity the acceleration of the cohesion force
    /// takes the place of g; 0 without both.
    pub over_mgd: f64,
}

/// m_ij of two grains of the mean mass, kg.
pub(super) fn effective_mass_of_mean(world: &World) -> f64 {
    let masses = &world.grains.masses;
    0.5 * (masses.iter().sum::<f64>() / masses.len() as f64)
}

/// The work of fracture of a law under which a bond of some C₀ (N) takes `work` (J).
pub(super) fn fracture_work_of(
    world: &World,
    physics: Physics,
    parameters: &Parameters,
    work: impl FnOnce(f64) -> f64,
) -> Option<FractureWork> {
    if !physics.cohesion {
        return None;
    }
    let (effective_mass, g) = (effective_mass_of_mean(world), world.gravity.magnitude());
    let acceleration = parameters.cohesion_acceleration(g);
    let joules = work(cohesion_force(parameters.bond, effective_mass, acceleration));
    let lift = 2.0 * effective_mass * parameters.accelerating(g) * world.mean_diameter;
    Some(FractureWork { joules, over_mgd: if lift > 0.0 { joules / lift } else { 0.0 } })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steppers_read_settings_that_exist_and_every_setting_is_read_by_one() {
        let remedies = |name: &str| crate::sim::remedies::ROWS.iter().any(|row| row.name == name);
        let names: Vec<&str> = Settings::about().map(|about| about.name).collect();
        for stepper in Stepper::ALL {
            for name in stepper.info().settings.split(' ') {
                assert!(names.contains(&name), "{stepper} reads {name}");
            }
        }
        for name in names {
            let read = Stepper::ALL.iter().any(|stepper| stepper.reads(name));
            assert!(read || remedies(name) || name == "stepper", "{name}");
        }
    }
}
