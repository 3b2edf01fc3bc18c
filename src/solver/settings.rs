//! How well a step is to be solved.

use super::methods::Method;
use super::ordering::Ordering;
use crate::error::Result;
use crate::setting::{Group, settings, words};

words! {
    /// What the tolerance of a solver refers to.
    #[derive(Default)]
    pub enum StopTest {
        /// ‖ΔP‖₂ of a sweep (of an iteration, for methods without sweeps) ≤ tolerance · ‖P‖₂, over normal
        /// and tangential impulses; dimensionless.
        #[default]
        RelativeChange = "relative-change", "‖ΔP‖ of a sweep over ‖P‖";
        /// Σ|ΔP| of a sweep ≤ tolerance · mean grain mass; m/s. Tested after every sweep.
        ImpulsePerMass = "impulse-per-mass", "sum of |ΔP| of a sweep over the mean mass, m/s";
        /// The common residual ≤ tolerance; dimensionless.
        Residual = "residual", "the residual that judges all methods";
    }
}

settings! {
    /// Method, stopping test and limits. Plain data, checked where a simulation takes them on.
    ///
    /// The default is for watching a pile: ten times looser than the figures of the paper are solved. A
    /// step that needs more than the limit has, as a rule, no solution to converge to: restitution asks
    /// wedged contacts for what their neighbours forbid.
    pub struct SolverSettings, changes SolverChanges, heading "Solver" {
        /// The method.
        method: Method = Method::Nsgs, {
            name: "solver",
            value_name: "NAME",
            help: "Method that solves each step",
            control: Some(Control {
                label: "Method",
                hint: "How the impulses of a step are found.",
                ..Control::PLAIN
            }),
        }
        /// The order of a sweep.
        #[serde(default, skip_serializing_if = "is_default")]
        ordering: Ordering = Ordering::Interleaved, {
            name: "ordering",
            value_name: "ORDER",
            help: "In which order a sweep visits the contacts",
            control: Some(Control {
                label: "Order",
                hint: "In which order a sweep visits contacts.",
                ..Control::PLAIN
            }),
        }
        /// What `tolerance` refers to.
        #[serde(default)]
        stop: StopTest = StopTest::RelativeChange, {
            name: "stop",
            value_name: "TEST",
            help: "What the tolerance refers to",
            control: Some(Control {
                label: "Stops on",
                hint: "What the tolerance refers to.",
                ..Control::PLAIN
            }),
        }
        /// In the unit of `stop`.
        tolerance: f64 = 1e-6, {
            name: "tolerance",
            value_name: "X",
            help: "How well each step is solved, in the unit of the stopping test",
            allowed: "a finite number > 0",
            holds: |value| value > 0.0 && value.is_finite(),
            control: Some(Control {
                label: "Tolerance",
                hint: "How well each step is solved; the answer depends on it.",
                range: [1e-12, 1e-1],
                logarithmic: true,
                ..Control::PLAIN
            }),
        }
        /// A step that needs more sweeps, or iterations of a method without sweeps, is reported as not
        /// converged.
        max_sweeps: u32 = 5_000, {
            name: "max-sweeps",
            value_name: "N",
            help: "A step that needs more sweeps is reported as not converged",
            allowed: "at least 1",
            holds: |value| value > 0,
            control: Some(Control {
                label: "Sweep limit",
                hint: "A step that needs more sweeps (or iterations) is reported as not converged.",
                range: [1.0, 100_000.0],
                logarithmic: true,
                ..Control::PLAIN
            }),
        }
        /// Start from the impulses of the step before.
        warm_start: bool = true, {
            name: "warm-start",
            value_name: "BOOL",
            help: "Whether each step starts from the impulses of the one before",
            control: Some(Control {
                label: "Warm start",
                hint: "Each step starts from the impulses of the one before.",
                ..Control::PLAIN
            }),
        }
    }
}

/// What came after the first scene files is written where it is not left at its default.
fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

impl SolverSettings {
    /// Checks the numbers against their ranges.
    ///
    /// # Errors
    /// Names the field, its value and its range.
    pub(crate) fn validate(&self) -> Result<()> {
        self.validate_each()
    }
}
