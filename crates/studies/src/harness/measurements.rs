//! Holds the parameters of runs, and the readings (named numbers) that were measured in these runs.

use serde::{Deserialize, Serialize};

use crate::number;

/// A reading: a measured number with its name.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Reading {
    pub name: String,
    #[serde(with = "number")]
    pub value: f64,
}

#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct RunReadings {
    pub readings: Vec<Reading>,
    pub simulated_secs: f64,
    pub steps: u64,
    /// Number of steps that the solver did not solve to its tolerance. The number has no meaning if the solver had to
    /// make a given number of sweeps, without a tolerance.
    pub unsolved_steps: u64,
    pub lost_grains: u32,
    /// True if positions or velocities of grains became NaN or infinite. Such a run has no readings (measured numbers).
    pub blew_up: bool,
}

impl RunReadings {
    /// Returns the measured number with the given name; NaN if the run has no number with this name.
    pub(crate) fn reading(&self, name: &str) -> f64 {
        let mut readings = self.readings.iter();
        readings.find(|reading| reading.name == name).map_or(f64::NAN, |reading| reading.value)
    }
}

pub(crate) fn named<const COUNT: usize>(readings: [(&str, f64); COUNT]) -> Vec<Reading> {
    readings.map(|(name, value)| Reading { name: name.to_owned(), value }).into()
}

#[derive(Clone, Debug)]
pub(crate) struct MeasuredCase {
    pub at: Vec<(&'static str, f64)>,
    pub run: RunReadings,
    pub wall_secs: f64,
}

impl MeasuredCase {
    /// Returns the value of the parameter with the given name, by which this run differs from others; NaN if the run
    /// has no such parameter.
    pub(crate) fn at(&self, name: &str) -> f64 {
        self.at.iter().find(|(known, _)| *known == name).map_or(f64::NAN, |(_, value)| *value)
    }

    /// Returns the number with the given name that was measured in this run; NaN if there is no number with this name.
    pub(crate) fn reading(&self, name: &str) -> f64 {
        self.run.reading(name)
    }
}

#[derive(Clone, Debug)]
pub(crate) struct Measurements<'a>(pub Vec<&'a MeasuredCase>);

impl<'a> Measurements<'a> {
    /// Returns the distinct values that the parameter with the given name has in these runs, in ascending order.
    pub(crate) fn values(&self, name: &str) -> Vec<f64> {
        let values = self.0.iter().map(|case| case.at(name));
        let mut values: Vec<f64> = values.filter(|value| !value.is_nan()).collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        values
    }

    pub(crate) fn list(&self, name: &str) -> String {
        self.values(name).iter().map(f64::to_string).collect::<Vec<_>>().join(", ")
    }

    /// Returns the value that the parameter with the given name has in the first run; 0 if there are no runs.
    pub(crate) fn first(&self, name: &str) -> f64 {
        self.0.first().map_or(0.0, |case| case.at(name))
    }

    pub(crate) fn such_that(&self, holds: impl Fn(&MeasuredCase) -> bool) -> Self {
        Self(self.0.iter().copied().filter(|case| holds(case)).collect())
    }

    pub(crate) fn with(&self, name: &str, value: f64) -> Self {
        self.such_that(|case| case.at(name) == value)
    }

    pub(crate) fn by_seed<T>(&self, of: impl Fn(Self) -> T) -> Vec<T> {
        self.values("seed").into_iter().map(|seed| of(self.with("seed", seed))).collect()
    }

    pub(crate) fn readings(&self, name: &str) -> Vec<f64> {
        self.0.iter().map(|case| case.reading(name)).collect()
    }

    /// Returns the number with the given name that was measured in the first run; NaN if there are no runs.
    pub(crate) fn reading(&self, name: &str) -> f64 {
        self.0.first().map_or(f64::NAN, |case| case.reading(name))
    }

    /// Returns the two numbers (x, y) that `point` computes from each measured run, sorted by x.
    pub(crate) fn rising(&self, point: impl Fn(&MeasuredCase) -> (f64, f64)) -> Vec<(f64, f64)> {
        let mut points = self.points(point);
        points.sort_by(|one, other| one.0.total_cmp(&other.0));
        points
    }

    pub(crate) fn points(&self, point: impl Fn(&MeasuredCase) -> (f64, f64)) -> Vec<(f64, f64)> {
        self.0.iter().map(|case| point(case)).collect()
    }

    pub(crate) fn seeds(&self) -> String {
        format!("{} seeds", self.values("seed").len())
    }
}
