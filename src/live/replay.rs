//! A recorded run, computed again by whoever wants all of its moments.

use std::ops::ControlFlow;

use super::{Change, HandMade, Recording};
use crate::error::{Error, Result};
use crate::sim::{RunEnding, Simulation};

/// All that is recorded of a world. A clone is cheap, and so is to be handed out: states are shared, and
/// whoever wants the moments between them steps by itself.
#[derive(Clone, Debug)]
pub struct Replay(Recording);

impl Replay {
    pub(super) fn of(recording: Recording) -> Self {
        Self(recording)
    }

    /// The state that the recording starts with.
    pub fn start(&self) -> &Simulation {
        self.0.start()
    }

    /// Simulated time of the last recorded step, s.
    pub fn end_secs(&self) -> f64 {
        self.0.end_secs()
    }

    /// The changes from a step on that steps up to a simulated time were taken with.
    pub fn changes(&self, from_step: u64, until_secs: f64) -> impl Iterator<Item = &Change> {
        self.0.changes(from_step, until_secs)
    }

    /// What a hand has done to the world, in its order.
    pub fn edits(&self) -> &[HandMade] {
        self.0.edits()
    }

    /// Computes the moments nearest to two simulated times, and all between them, bit for bit as they were.
    /// `each` is called with every state on the way, in the order of time, and whether it is one of those; its
    /// settings are those of the step that led there. It can end this.
    ///
    /// # Errors
    /// What `each` fails with.
    pub fn run(
        &self,
        [from_secs, until_secs]: [f64; 2],
        mut each: impl FnMut(&Simulation, bool) -> Result<ControlFlow<()>>,
    ) -> Result<RunEnding> {
        let mut simulation = self.0.keyframe_on_the_way_to(from_secs).clone();
        if simulation.observables().step == 0 {
            // No step led to the start: it has the settings of the first.
            self.0.restore_controls(&mut simulation);
        }
        loop {
            let is_within = self.0.has_come_to(&simulation, from_secs);
            if each(&simulation, is_within)?.is_break() {
                return Ok(RunEnding::Stopped);
            }
            if self.0.has_come_to(&simulation, until_secs) {
                return Ok(RunEnding::Done);
            }
            self.0.restore_controls(&mut simulation);
            match simulation.step() {
                Ok(_) => {}
                Err(failure @ Error::NonFinite { .. }) => return Ok(RunEnding::NotFinite(failure)),
                Err(error) => return Err(error),
            }
        }
    }
}
