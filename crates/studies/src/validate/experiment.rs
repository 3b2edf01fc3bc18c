//! What an experiment is: cases that are computed, and quantities that are made of what they come to.

use serde::{Deserialize, Serialize};

use super::quantity::Quantity;
use super::way::Way;
use crate::error::Result;
use crate::number;

/// A published experiment.
pub(super) struct Experiment {
    /// Its name on the command line.
    pub name: &'static str,
    /// Above its part of the report and its chart.
    pub title: &'static str,
    /// What is done, and after whom.
    pub about: &'static str,
    /// What is computed.
    pub cases: Cases,
    /// What the cases of one way come to.
    pub judge: fn(&[Found]) -> Vec<Quantity>,
}

/// The cases of an experiment, those of a quick pass where that is asked for.
pub(super) enum Cases {
    /// It is about methods of its own, whichever are chosen.
    Own(fn(bool) -> Vec<Case>),
    /// It is computed in each way that is chosen, but for those by which it has no cases.
    Chosen(fn(bool, Way) -> Vec<Case>),
}

/// What computes a case.
pub(super) type Run = Box<dyn Fn() -> Result<Measured> + Send + Sync>;

/// One run.
pub(super) struct Case {
    /// Numbers that tell it from the others of its experiment and way.
    pub at: Vec<(&'static str, f64)>,
    /// How long it may take, in the unit of all cases: grains times steps.
    pub cost: f64,
    pub run: Run,
}

/// A number that was measured.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Reading {
    pub name: String,
    #[serde(with = "number")]
    pub value: f64,
}

/// What one run comes to.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Measured {
    pub readings: Vec<Reading>,
    pub simulated_secs: f64,
    pub steps: u64,
    /// Steps that were not solved as asked. With a number of sweeps nothing is asked but those.
    pub unsolved_steps: u64,
    pub lost_grains: u32,
    /// Whether its state was no longer finite; it has no readings then.
    pub blew_up: bool,
}

/// What became of a case.
#[derive(Clone, Debug)]
pub(super) struct Found {
    pub at: Vec<(&'static str, f64)>,
    pub measured: Measured,
    /// Wall-clock time, s.
    pub wall_secs: f64,
}

impl Found {
    /// A number that its case has; NaN where there is none of that name.
    pub(super) fn at(&self, name: &str) -> f64 {
        self.at.iter().find(|(known, _)| *known == name).map_or(f64::NAN, |(_, value)| *value)
    }

    /// A number that was measured; NaN where there is none of that name.
    pub(super) fn reading(&self, name: &str) -> f64 {
        let mut readings = self.measured.readings.iter();
        readings.find(|reading| reading.name == name).map_or(f64::NAN, |reading| reading.value)
    }
}

/// The different values of a number of some cases, rising.
pub(super) fn values(found: &[Found], name: &str) -> Vec<f64> {
    let mut values: Vec<f64> = found.iter().map(|one| one.at(name)).collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}

/// The cases with that value of a number.
pub(super) fn with<'a>(
    found: &'a [Found],
    name: &'a str,
    value: f64,
) -> impl Iterator<Item = &'a Found> {
    found.iter().filter(move |one| one.at(name) == value)
}
