//! Computing times of a step: contact detection, solver and total.

/// Computing times of one step, s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepTimes {
    /// Computing time of contact detection, s: finding candidate pairs and contacts.
    pub detection_secs: f64,
    /// Computing time of the solver, s, including the solution of collisions; 0 for steppers whose substeps need no
    /// solver.
    pub solving_secs: f64,
    /// Computing time of the whole step, s. It also includes preparation, the motion of grains and the measurements.
    pub total_secs: f64,
}

/// Clock that adds up the computing times of contact detection and solver in a step. Without a clock function it
/// measures nothing.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stopwatch {
    pub clock: Option<fn() -> f64>,
    pub times: StepTimes,
}

impl Stopwatch {
    /// Returns the time since an arbitrary fixed date, s; always 0 without a clock function.
    pub(crate) fn now(&self) -> f64 {
        self.clock.map_or(0.0, |clock| clock())
    }
}
