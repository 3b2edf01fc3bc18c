//! Runs that differ in their start alone.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::{Map, Value};

/// Runs that differ in their start alone.
#[derive(Default, Serialize)]
pub(super) struct RunGroup {
    /// What varies between groups.
    pub settings: Map<String, Value>,
    /// Runs that have a number: those that came to an end and lost no grain.
    pub starts: usize,
    /// Those that did not.
    pub spoilt: usize,
    /// Mean slump, and half its 95 % interval; `null` if no start has a slump, and with one start.
    pub slump: [f64; 2],
    /// The same of this slump less that under the first value of a list, all else alike, over the starts of both. By the
    /// first name of the list.
    pub less_first: BTreeMap<String, [f64; 2]>,
    /// Share of the steps that were not solved as asked.
    pub unsolved: f64,
    /// The largest bound that a step had on the velocities' error, m/s;
    /// `null` if a state was no longer finite.
    pub largest_velocity_error: f64,
    /// The largest of the runs' mean overlaps, d.
    pub mean_overlap: f64,
    /// Time of a run in the mean, s.
    pub secs: f64,
}
