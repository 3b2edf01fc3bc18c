//! Since when Δt has been what it is: which step comes at which time hangs on it.

use serde::{Deserialize, Serialize};

use super::observables::Observables;
use crate::world::Parameters;

/// The moment since which Δt has been what it is.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Steady {
    step: u64,
    time_secs: f64,
}

impl Steady {
    /// Since the moment of these observables.
    pub(super) fn since(observables: &Observables) -> Self {
        let Observables { step, time_secs, .. } = *observables;
        Self { step, time_secs }
    }

    /// The step whose end is nearest to a simulated time, s.
    pub(super) fn step_at(self, secs: f64, parameters: &Parameters) -> u64 {
        self.step.saturating_add(parameters.steps_in(secs - self.time_secs))
    }
}
