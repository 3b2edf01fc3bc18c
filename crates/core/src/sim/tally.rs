//! What a whole run amounts to.

use serde::{Deserialize, Serialize};

use super::Observables;
use crate::number;
use crate::solver::worst;

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
    /// Those of them that were solved under bounds of friction instead.
    #[serde(default)]
    pub fallback_steps: u64,
    /// Sweeps of all steps.
    pub sweeps: u64,
    /// Largest common residual of any step.
    #[serde(with = "number")]
    pub largest_residual: f64,
    /// Mean over the steps of the mean overlap, in units of d.
    #[serde(with = "number")]
    pub mean_overlap: f64,
    /// Largest overlap of any contact in any step, in units of d.
    #[serde(with = "number")]
    pub max_overlap: f64,
    /// Mean over the steps of the number of contacts.
    #[serde(with = "number", default)]
    pub mean_contacts: f64,
}

impl Tally {
    /// Counts one more step; the last one too if its state is no longer finite.
    pub fn add(&mut self, step: &Observables) {
        self.steps += 1;
        self.unconverged_steps += u64::from(!step.converged);
        self.stalled_steps += u64::from(step.stalled);
        self.fallback_steps += u64::from(step.fell_back == Some(true));
        self.sweeps += u64::from(step.sweeps);
        self.largest_residual = worst(self.largest_residual, step.residual);
        self.mean_overlap += (step.mean_overlap - self.mean_overlap) / self.steps as f64;
        self.max_overlap = worst(self.max_overlap, step.max_overlap);
        self.mean_contacts += (f64::from(step.contacts) - self.mean_contacts) / self.steps as f64;
    }
}
