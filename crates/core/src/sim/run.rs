//! Many steps in a row, and what is done to the grains between them.

use std::ops::ControlFlow;

use glam::DVec2;

use super::simulation::Simulation;
use super::state::State;
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

    /// Sets all velocities to zero and forgets the contacts' impulses.
    pub fn bring_to_rest(&mut self) {
        let State { world, contacts, .. } = &mut self.state;
        world.grains.velocities.fill(DVec2::ZERO);
        world.grains.angular_velocities.fill(0.0);
        contacts.scale_impulses(0.0);
        contacts.forget();
    }

    /// Multiplies all velocities, as a drag during the last step would have.
    pub fn scale_velocities(&mut self, factor: f64) {
        let grains = &mut self.state.world.grains;
        for velocity in &mut grains.velocities {
            *velocity *= factor;
        }
        for spin in &mut grains.angular_velocities {
            *spin *= factor;
        }
    }
}
