//! Known remedies for known failures, all off in the paper's scheme.

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};

/// Remedies that the step of a method that solves its problem can take. A scheme that replaces the
/// step has its own ways.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Remedies {
    /// Push overlap out by moving grains apart after the step, without giving them speed.
    pub push_out: bool,
    /// Cut a step into pieces in which no grain moves further than this, in d; 0 never does.
    pub max_travel: f64,
    /// Solve a step that did not converge once more without bounces: restitution can ask wedged
    /// contacts for what contradicts itself, and then a step has no solution with them.
    pub calm_unsolved: bool,
    /// Have shocks run through touching grains one after the other (`solver::impacts`), in scenes
    /// without cohesion.
    pub sequential_impacts: bool,
}

impl Remedies {
    /// No remedy: the paper's scheme.
    pub const NONE: Self =
        Self { push_out: false, max_travel: 0.0, calm_unsolved: false, sequential_impacts: false };

    /// Whether there are none.
    pub fn is_none(&self) -> bool {
        *self == Self::NONE
    }

    /// Checks the numbers against their ranges.
    ///
    /// # Errors
    /// Names the field, its value and its range.
    pub fn validate(&self) -> Result<()> {
        if self.max_travel >= 0.0 && self.max_travel.is_finite() {
            return Ok(());
        }
        let allowed = "a finite number of diameters ≥ 0; 0 never cuts a step";
        Err(Error::value("max-travel", self.max_travel, allowed))
    }
}
