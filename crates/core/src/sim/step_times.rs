//! Where the time of a step goes.

use crate::error::Result;
use crate::sim::simulation::Simulation;

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
    clock: Option<fn() -> f64>,
    pub times: StepTimes,
}

impl Stopwatch {
    /// s since some moment; always the same without a clock.
    pub(crate) fn now(&self) -> f64 {
        self.clock.map_or(0.0, |clock| clock())
    }
}

impl Simulation {
    /// Takes one step and tells what it took by a clock, which gives s since some moment. The step is the one that
    /// [`Simulation::step`] would have taken.
    ///
    /// # Errors
    /// As [`Simulation::step`].
    pub fn timed_step(&mut self, clock: fn() -> f64) -> Result<StepTimes> {
        self.state.stopwatch = Stopwatch { clock: Some(clock), ..Stopwatch::default() };
        let begun = clock();
        let outcome = self.step().map(|_| ());
        let total_secs = clock() - begun;
        let times = std::mem::take(&mut self.state.stopwatch).times;
        outcome.map(|()| StepTimes { total_secs, ..times })
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU32, Ordering};

    use super::*;
    use crate::scene::built_in;
    use crate::sim::Stepper;

    /// A clock that goes on by one each time it is looked at.
    fn looks() -> f64 {
        static LOOKS: AtomicU32 = AtomicU32::new(0);
        f64::from(LOOKS.fetch_add(1, Ordering::Relaxed))
    }

    #[test]
    fn a_timed_step_is_the_step_and_its_parts_are_within_it() {
        for &stepper in Stepper::ALL {
            let mut scene = built_in("pile").unwrap();
            scene.stepper = stepper;
            let mut timed = scene.simulation().unwrap();
            timed.take_steps(3).unwrap();
            let mut untimed = timed.clone();
            untimed.step().unwrap();
            let times = timed.timed_step(looks).unwrap();
            let name = stepper.name();
            assert_eq!(timed.snapshot().state_hash(), untimed.snapshot().state_hash(), "{name}");
            let StepTimes { detection_secs, solving_secs, total_secs } = times;
            assert!(detection_secs > 0.0, "{name}: {times:?}");
            assert_eq!(solving_secs > 0.0, stepper.uses_method(), "{name}: {times:?}");
            assert!(detection_secs + solving_secs < total_secs, "{name}: {times:?}");
            assert!(timed.state.stopwatch.clock.is_none(), "the next step is not timed");
        }
    }
}
