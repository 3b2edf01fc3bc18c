//! What a whole run amounts to.

use serde::{Deserialize, Serialize};

use super::Observables;

/// Sums over the steps of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tally {
    /// Steps taken.
    pub steps: u64,
    /// Steps whose stopping test was not met within the sweep limit.
    pub unconverged_steps: u64,
    /// Those of them that had stalled, so that more sweeps are of no use.
    #[serde(default)]
    pub stalled_steps: u64,
    /// Sweeps of all steps.
    pub sweeps: u64,
    /// Largest common residual of any step.
    pub largest_residual: f64,
    /// Mean over the steps of the mean overlap, in units of d.
    pub mean_overlap: f64,
    /// Largest overlap of any contact in any step, in units of d.
    pub max_overlap: f64,
}

impl Tally {
    /// Counts one more step.
    pub fn add(&mut self, step: &Observables) {
        self.steps += 1;
        self.unconverged_steps += u64::from(!step.converged);
        self.stalled_steps += u64::from(step.stalled);
        self.sweeps += u64::from(step.sweeps);
        self.largest_residual = self.largest_residual.max(step.residual);
        self.mean_overlap += (step.mean_overlap - self.mean_overlap) / self.steps as f64;
        self.max_overlap = self.max_overlap.max(step.max_overlap);
    }
}
