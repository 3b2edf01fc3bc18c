//! Defines groups of runs that only differ in their initial state.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::{Map, Value};

/// A group of runs that only differ in their initial state.
#[derive(Default, Serialize)]
pub(super) struct RunGroup {
    /// Varied settings, with their values in this group.
    pub settings: Map<String, Value>,
    /// Number of valid runs, which ended with a finite state and lost no grain.
    pub starts: usize,
    /// Number of invalid runs, which lost a grain or ended with a state that is not finite.
    pub spoilt: usize,
    /// Mean slump, and half its 95 % interval. Both are `null` if no run is valid; half the interval is also `null` for
    /// a single run.
    pub slump: [f64; 2],
    /// Effects of the varied settings on the slump. The key is the name of the setting, or the first name if several
    /// settings vary together. An effect is the difference of the slump between this group and the group that has the
    /// first value of the setting and otherwise the same settings: the mean over the initial states that both groups
    /// share, and half its 95 % interval.
    pub less_first: BTreeMap<String, [f64; 2]>,
    /// Fraction of steps that missed their tolerance.
    pub unsolved: f64,
    /// Largest estimated velocity error of a step, m/s; `null` if a state was no longer finite.
    pub largest_velocity_error: f64,
    /// Largest of the runs' mean overlaps (means over all steps), in mean diameters d.
    pub mean_overlap: f64,
    /// Mean computing time of a run, s.
    pub secs: f64,
}
