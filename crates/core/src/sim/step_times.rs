//! Where the time of a step goes.

/// What a step took, s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepTimes {
    /// Finding who may touch, and who does.
    pub detection_secs: f64,
    /// Solving the step's problems, shocks included; none of steppers whose substeps push by formula.
    pub solving_secs: f64,
    /// All of it: besides these two, setting up, moving, measuring.
    pub total_secs: f64,
}

/// Adds up what parts of a step take, where there is a clock.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stopwatch {
    pub clock: Option<fn() -> f64>,
    pub times: StepTimes,
}

impl Stopwatch {
    /// s since some moment; always the same without a clock.
    pub(crate) fn now(&self) -> f64 {
        self.clock.map_or(0.0, |clock| clock())
    }
}
