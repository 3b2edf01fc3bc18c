//! What the room of a way to step says of it.

use super::mean_pair::FractureWork;
use crate::error::Result;
use crate::world::{Parameters, Physics, World};

/// What there is to know of a way to step, beside its name and its line.
#[derive(Clone, Copy, Debug)]
pub struct StepperInfo {
    /// What a step of it solves, one line.
    pub solves: &'static str,
    /// Where it comes from.
    pub source: &'static str,
    /// The settings that it reads, by name. With `solver` among them it solves the step's problem by a
    /// method.
    pub settings: &'static [&'static str],
    /// Observables that it has beside those that all have.
    pub observables: &'static [&'static str],
    /// Whether it moves walls that a force drives.
    pub takes_drives: bool,
    /// Refuses numbers that do not go with it.
    pub check: fn(&Parameters) -> Result<()>,
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
        settings: &[],
        observables: &[],
        takes_drives: false,
        check: |_| Ok(()),
        substeps: |_, _, _| 1,
        critical_time_step_secs: |_, _, _| None,
        contact_time_secs: |_, _, _| None,
        fracture_work: |_, _, _| None,
    };
}
