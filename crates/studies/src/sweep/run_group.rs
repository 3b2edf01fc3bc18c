//! Defines groups of runs that only differ in their initial state.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::{Map, Value};

/// A group of runs that only differ in their initial state.
#[derive(Default, Serialize)]
pub(super) struct RunGroup {
    /// Varied settings, with their values in this group.
    pub settings: Map<String, Value>,
    /// Number of valid runs: runs that reached their end, with finite positions and velocities, and in which no grain
    /// left the scene.
    pub starts: usize,
    /// Number of invalid runs: a grain left the scene, or positions or velocities became NaN or infinite.
    pub spoilt: usize,
    /// Mean slump of the valid runs, and the half-width of its 95 % confidence interval. In the file `report.json` both
    /// are `null` if no run is valid; the half-width is also `null` for a single run.
    pub slump: [f64; 2],
    /// Effects of the varied settings on the slump. The key is the name of the setting, or the first name if several
    /// settings vary together. An effect is the slump of this group minus the slump of the group that has the first
    /// value of the setting and otherwise the same settings. The two numbers are the mean over the initial states that
    /// both groups share, and the half-width of its 95 % confidence interval.
    pub less_first: BTreeMap<String, [f64; 2]>,
    /// Fraction of the steps of all runs that were not solved to their tolerance.
    pub unsolved: f64,
    /// Largest estimated velocity error of a step in any run, m/s; `null` in the file `report.json` if it is NaN or
    /// infinite.
    pub largest_velocity_error: f64,
    /// Mean overlap of contacts over all steps of a run, in mean diameters d: the largest value among the runs.
    pub mean_overlap: f64,
    /// Mean computing time of a run, s.
    pub secs: f64,
}
