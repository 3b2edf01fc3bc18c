//! What can be changed between two steps, and when it was.

use serde::{Deserialize, Serialize};

use crate::sim::{Edit, Pull, Settings, Simulation};

/// All that can be changed between two steps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Controls {
    /// How the next step is taken.
    pub settings: Settings,
    /// Spring on a grain.
    pub pull: Option<Pull>,
}

impl Controls {
    /// Those of a simulation's next step.
    pub(crate) fn of(simulation: &Simulation) -> Self {
        Self { settings: *simulation.settings(), pull: simulation.pull() }
    }
}

/// A moment from which on other controls are in force.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Change {
    /// The step before the first that they are in force for.
    pub after_step: u64,
    /// Simulated time of that step, s.
    pub time_secs: f64,
    /// What is in force up to the next change.
    pub controls: Controls,
}

/// What a hand did between two steps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HandMade {
    /// The step before.
    pub after_step: u64,
    /// What was done.
    pub edit: Edit,
}
