//! Known remedies for known failures, all off in the paper's scheme.

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::world::ContactLaw;

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
    /// Let pairs with a gap that would close within the step close that gap and no more
    /// (`sim::speculative`).
    pub speculative: bool,
}

impl Remedies {
    /// No remedy: the paper's scheme.
    pub const NONE: Self = Self {
        push_out: false,
        max_travel: 0.0,
        calm_unsolved: false,
        sequential_impacts: false,
        speculative: false,
    };

    /// Whether there are none.
    pub fn is_none(&self) -> bool {
        *self == Self::NONE
    }

    /// Those of them that go with a law. The law `range` pushes overlap out by itself, and solves a
    /// step more than once, shocks apart from loads: it has its own ways for all but fast grains.
    pub fn under(self, law: ContactLaw) -> Self {
        match law {
            ContactLaw::Moreau => self,
            ContactLaw::Range => Self { max_travel: self.max_travel, ..Self::NONE },
        }
    }

    /// Checks that a law takes them all.
    ///
    /// # Errors
    /// Names the first that it does not take.
    pub fn validate_under(&self, law: ContactLaw) -> Result<()> {
        let taken = self.under(law);
        let refuse = |field: &str, why: &str| {
            Err(Error::value(field, true, format!("false where law is range, {why}")))
        };
        if self.push_out != taken.push_out {
            return refuse("push-out", "which pushes overlap out by itself");
        }
        if self.calm_unsolved != taken.calm_unsolved {
            return refuse("calm-unsolved", "which solves shocks and loads apart");
        }
        if self.sequential_impacts != taken.sequential_impacts {
            return refuse("sequential-impacts", "which solves shocks and loads apart");
        }
        if self.speculative != taken.speculative {
            return refuse("speculative", "which looks ahead by itself");
        }
        Ok(())
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
