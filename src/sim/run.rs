//! Many steps in a row.

use std::ops::ControlFlow;

use super::simulation::Simulation;
use crate::error::{Error, Result};

/// How many steps in a row ended.
#[derive(Debug)]
pub enum RunEnding {
    /// All steps were taken.
    Done,
    /// A call after a step said so.
    Stopped,
    /// The state is no longer finite, for this reason.
    NotFinite(Error),
}

impl Simulation {
    /// Takes so many steps. `after` is called after each, and can end the run. A state that is no
    /// longer finite ends it too, and is no error of the run's.
    ///
    /// # Errors
    /// What `after` fails with.
    pub fn run(
        &mut self,
        steps: u64,
        mut after: impl FnMut(&Self) -> Result<ControlFlow<()>>,
    ) -> Result<RunEnding> {
        for _ in 0..steps {
            match self.step() {
                Ok(_) => {}
                Err(failure @ Error::NonFinite { .. }) => return Ok(RunEnding::NotFinite(failure)),
                Err(error) => return Err(error),
            }
            if after(self)?.is_break() {
                return Ok(RunEnding::Stopped);
            }
        }
        Ok(RunEnding::Done)
    }

    /// Takes so many steps.
    ///
    /// # Errors
    /// Where the state is no longer finite after one of them.
    pub fn take_steps(&mut self, steps: u64) -> Result<()> {
        match self.run(steps, |_| Ok(ControlFlow::Continue(())))? {
            RunEnding::NotFinite(failure) => Err(failure),
            RunEnding::Done | RunEnding::Stopped => Ok(()),
        }
    }
}
