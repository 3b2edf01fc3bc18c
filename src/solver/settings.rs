//! How well a step is to be solved.

use serde::{Deserialize, Serialize};

use super::{Method, Ordering, Remedies};
use crate::error::{Error, Result};

/// What the tolerance of a solver refers to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum StopTest {
    /// ‖ΔP‖₂ of a sweep (of an iteration, for methods without sweeps) ≤ tolerance · ‖P‖₂, over normal and tangential impulses; dimensionless.
    #[default]
    RelativeChange,
    /// Σ|ΔP| of a sweep ≤ tolerance · mean grain mass; m/s. Tested after every sweep.
    ImpulsePerMass,
    /// The common residual ≤ tolerance; dimensionless.
    Residual,
}

/// Method, stopping test and limits.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SolverSettings {
    /// The method.
    pub method: Method,
    /// The order of a sweep.
    #[serde(default, skip_serializing_if = "is_default")]
    pub ordering: Ordering,
    /// What `tolerance` refers to.
    #[serde(default)]
    pub stop: StopTest,
    /// In the unit of `stop`.
    pub tolerance: f64,
    /// A step that needs more sweeps, or iterations of a method without sweeps, is reported as not
    /// converged.
    pub max_sweeps: u32,
    /// Start from the impulses of the step before.
    pub warm_start: bool,
    /// Substeps of a scheme that replaces the step; 0 leaves the number to the scheme. Methods that
    /// solve the step's problem take none.
    #[serde(default, skip_serializing_if = "is_default")]
    pub substeps: u32,
    /// Remedies for known failures; none in the paper's scheme.
    #[serde(default, skip_serializing_if = "Remedies::is_none")]
    pub remedies: Remedies,
}

/// More substeps than this are a mistake: a single step of a pile would take many seconds.
pub const MAX_SUBSTEPS: u32 = 100_000;

/// What came after the first scene files is written where it is not left at its default.
fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

impl SolverSettings {
    /// Checks the numbers against their ranges.
    ///
    /// # Errors
    /// Names the field, its value and its range.
    pub fn validate(&self) -> Result<()> {
        if !(self.tolerance > 0.0 && self.tolerance.is_finite()) {
            return Err(Error::value("tolerance", self.tolerance, "a finite number > 0"));
        }
        if self.max_sweeps == 0 {
            return Err(Error::value("max-sweeps", 0, "at least 1"));
        }
        if self.substeps > MAX_SUBSTEPS {
            let allowed = format!("at most {MAX_SUBSTEPS}; 0 leaves it to the scheme");
            return Err(Error::value("substeps", self.substeps, allowed));
        }
        self.remedies.validate()
    }
}

impl Default for SolverSettings {
    /// For watching a pile: ten times looser than the figures of the paper are solved. A step
    /// that needs more than the limit has, as a rule, no solution to converge to: restitution asks
    /// wedged contacts for what their neighbours forbid.
    fn default() -> Self {
        Self {
            method: Method::Nsgs,
            ordering: Ordering::Interleaved,
            stop: StopTest::RelativeChange,
            tolerance: 1e-6,
            max_sweeps: 5_000,
            warm_start: true,
            substeps: 0,
            remedies: Remedies::default(),
        }
    }
}
