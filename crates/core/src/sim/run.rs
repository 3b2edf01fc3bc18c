//! Runs of many steps, changes of the velocities between them, and statistics of a run.

use std::ops::ControlFlow;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::number;
use crate::sim::Observables;
use crate::sim::simulation::Simulation;
use crate::sim::state::State;
use crate::solver::worst;

/// Reason why a run of many steps ended.
#[derive(Debug)]
pub enum RunEnding {
    /// All requested steps were taken.
    Done,
    /// The function that is called after each step ended the run.
    Stopped,
    /// A position, a velocity or the kinetic energy is no longer finite. Contains the error of the last step.
    NotFinite(Error),
}

impl Simulation {
    /// Takes up to `steps` steps. `after` is called after each step and can end the run. The run also ends if a
    /// position, a velocity or the kinetic energy is no longer finite, and then returns [`RunEnding::NotFinite`].
    ///
    /// # Errors
    /// An error returned by `after`.
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
    /// Fails if a position, a velocity or the kinetic energy is no longer finite after a step.
    pub fn take_steps(&mut self, steps: u64) -> Result<()> {
        match self.run(steps, |_| Ok(ControlFlow::Continue(())))? {
            RunEnding::NotFinite(failure) => Err(failure),
            RunEnding::Done | RunEnding::Stopped => Ok(()),
        }
    }

    /// Sets the velocities of all grains to zero, and clears the impulses that contacts keep from the last step as
    /// starting values of the next step.
    pub fn bring_to_rest(&mut self) {
        let State { world, contacts, .. } = &mut self.state;
        world.grains.velocities.fill(DVec2::ZERO);
        world.grains.angular_velocities.fill(0.0);
        contacts.scale_impulses(0.0);
        contacts.forget();
    }

    /// Multiplies the velocities and angular velocities of all grains by `factor`. A factor below 1 has the effect of a
    /// drag force during the last step.
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

/// Statistics over the steps of a run: numbers of steps and sweeps, largest errors, and mean and largest overlap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tally {
    /// Number of steps of the run.
    pub steps: u64,
    /// Number of unsolved steps: the solver did not meet its stop criterion within the sweep limit.
    pub unconverged_steps: u64,
    /// Number of unsolved steps whose residual had stopped decreasing, so that more sweeps do not help.
    #[serde(default)]
    pub stalled_steps: u64,
    /// Total number of sweeps of all steps.
    pub sweeps: u64,
    /// Largest residual of any step, dimensionless: the relative error of the step's contact problem.
    #[serde(with = "number")]
    pub largest_residual: f64,
    /// Largest estimated error of the velocities in any step, m/s.
    #[serde(with = "number", default)]
    pub largest_velocity_error: f64,
    /// Mean overlap of touching grain pairs, averaged over the steps, in mean diameters d.
    #[serde(with = "number")]
    pub mean_overlap: f64,
    /// Largest overlap of any contact in any step, in mean diameters d.
    #[serde(with = "number")]
    pub max_overlap: f64,
    /// Number of contacts, averaged over the steps.
    #[serde(with = "number", default)]
    pub mean_contacts: f64,
}

impl Tally {
    /// Adds the measurements after one step to the statistics. Also counts a last step whose state is not finite.
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
