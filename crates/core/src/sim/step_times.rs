//! Computing times of the parts of a step.

/// Computing times of the parts of one step, s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepTimes {
    /// Time of detection, s: finding candidate pairs and contacts.
    pub detection_secs: f64,
    /// Time of the solver, s, including the solution of shocks; 0 for steppers whose substeps need no solver.
    pub solving_secs: f64,
    /// Time of the whole step, s. It also includes preparation, motion and measurement.
    pub total_secs: f64,
}

/// Clock that adds up the computing times of a step's parts. Without a clock function it measures nothing.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stopwatch {
    pub clock: Option<fn() -> f64>,
    pub times: StepTimes,
}

impl Stopwatch {
    /// Returns the seconds since an arbitrary fixed moment; constant without a clock.
    pub(crate) fn now(&self) -> f64 {
        self.clock.map_or(0.0, |clock| clock())
    }
}
