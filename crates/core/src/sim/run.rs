//! Consecutive steps, changes of the grains between them, and statistics of a run.

use std::ops::ControlFlow;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::number;
use crate::sim::Observables;
use crate::sim::simulation::Simulation;
use crate::sim::state::State;
use crate::solver::worst;

/// Reason for the end of consecutive steps.
#[derive(Debug)]
pub enum RunEnding {
    /// All steps were taken.
    Done,
    /// A call after a step ended the run.
    Stopped,
    /// The state is no longer finite, with the error.
    NotFinite(Error),
}

impl Simulation {
    /// Takes `steps` steps. `after` is called after each step and can end the run. A state that is no longer finite
    /// ends the run too, but is not returned as an error.
    ///
    /// # Errors
    /// The error of `after`.
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

    /// Takes `steps` steps.
    ///
    /// # Errors
    /// If the state is no longer finite after one of them.
    pub fn take_steps(&mut self, steps: u64) -> Result<()> {
        match self.run(steps, |_| Ok(ControlFlow::Continue(())))? {
            RunEnding::NotFinite(failure) => Err(failure),
            RunEnding::Done | RunEnding::Stopped => Ok(()),
        }
    }

    /// Sets all velocities to zero and clears the contacts' impulses.
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

/// Statistics over the steps of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tally {
    /// Number of steps.
    pub steps: u64,
    /// Number of steps whose stopping test was not met within the sweep limit.
    pub unconverged_steps: u64,
    /// Number of these steps that had stalled, so that more sweeps do not help.
    #[serde(default)]
    pub stalled_steps: u64,
    /// Total number of sweeps.
    pub sweeps: u64,
    /// Largest common residual of any step.
    #[serde(with = "number")]
    pub largest_residual: f64,
    /// Largest estimated velocity error of any step, m/s.
    #[serde(with = "number", default)]
    pub largest_velocity_error: f64,
    /// Mean over the steps of the mean overlap, in units of d.
    #[serde(with = "number")]
    pub mean_overlap: f64,
    /// Largest overlap of any contact in any step, in units of d.
    #[serde(with = "number")]
    pub max_overlap: f64,
    /// Mean number of contacts over the steps.
    #[serde(with = "number", default)]
    pub mean_contacts: f64,
}

impl Tally {
    /// Counts one more step, also the last one if its state is no longer finite.
    pub fn add(&mut self, step: &Observables) {
        self.steps += 1;
        self.unconverged_steps += u64::from(!step.converged);
        self.stalled_steps += u64::from(step.stalled);
        self.sweeps += u64::from(step.sweeps);
        self.largest_residual = worst(self.largest_residual, step.residual);
        self.largest_velocity_error = worst(self.largest_velocity_error, step.velocity_error);
        self.mean_overlap += (step.mean_overlap - self.mean_overlap) / self.steps as f64;
        self.max_overlap = worst(self.max_overlap, step.max_overlap);
        self.mean_contacts += (f64::from(step.contacts) - self.mean_contacts) / self.steps as f64;
    }
}
