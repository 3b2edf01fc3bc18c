//! Computing time of a step's parts.

/// Computing time of a step, s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepTimes {
    /// Detection: finding candidates and contacts.
    pub detection_secs: f64,
    /// Solving the step's problems, including shocks; 0 for steppers whose substeps push by a formula.
    pub solving_secs: f64,
    /// Total, which also includes preparation, motion and measurement.
    pub total_secs: f64,
}

/// Adds up the times of a step's parts if there is a clock.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stopwatch {
    pub clock: Option<fn() -> f64>,
    pub times: StepTimes,
}

impl Stopwatch {
    /// Seconds since any moment; constant without a clock.
    pub(crate) fn now(&self) -> f64 {
        self.clock.map_or(0.0, |clock| clock())
    }
}
