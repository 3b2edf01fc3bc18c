//! Groups of runs that only differ in their initial state.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::{Map, Value};

/// Runs that only differ in their initial state.
#[derive(Default, Serialize)]
pub(super) struct RunGroup {
    /// The varied settings of the group.
    pub settings: Map<String, Value>,
    /// Number of valid runs, which ended with a finite state and lost no grain.
    pub starts: usize,
    /// Number of invalid runs.
    pub spoilt: usize,
    /// Mean slump, and half its 95 % interval; `null` if no run is valid, and for a single run.
    pub slump: [f64; 2],
    /// Difference between this slump and that under the first value of a list, with all other settings equal, over the
    /// initial states of both; mean and half the interval. Keyed by the first name of the list.
    pub less_first: BTreeMap<String, [f64; 2]>,
    /// Fraction of unsolved steps.
    pub unsolved: f64,
    /// The largest error bound of the velocities in a step, m/s; `null` if a state was no longer finite.
    pub largest_velocity_error: f64,
    /// The largest of the runs' mean overlaps, d.
    pub mean_overlap: f64,
    /// Mean duration of a run, s.
    pub secs: f64,
}
