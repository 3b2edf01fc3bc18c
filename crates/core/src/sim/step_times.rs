//! Computing times of a step: contact detection, solver and total.

/// Computing times of one step, s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepTimes {
    /// Computing time of contact detection, s: finding candidate pairs (pairs of bodies that may touch soon) and
    /// contacts.
    pub detection_secs: f64,
    /// Computing time of the solver, s, including the solution of collisions; 0 for the steppers that divide a step
    /// into substeps without a solver (`tgs-soft`, `avbd` and `dem`).
    pub solving_secs: f64,
    /// Computing time of the whole step, s. It also includes preparation, the motion of grains and the measurements.
    pub total_secs: f64,
}

/// Clock that adds up the computing times of contact detection and solver in a step. It reads the time from the
/// function `clock`; if `clock` is `None`, all times stay 0.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stopwatch {
    pub clock: Option<fn() -> f64>,
    pub times: StepTimes,
}

impl Stopwatch {
    /// Returns the time since an arbitrary fixed date, s, from the function `clock`; always 0 if `clock` is `None`.
    pub(crate) fn now(&self) -> f64 {
        self.clock.map_or(0.0, |clock| clock())
    }
}
