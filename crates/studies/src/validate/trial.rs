//! A run that is watched: what its steps amount to beside what it is run for.

use super::experiment::{Measured, Reading};
use crate::error::Result;
use crate::scene::Scene;
use crate::sim::{Simulation, Tally};

/// A run on its way.
pub(super) struct Trial {
    pub simulation: Simulation,
    tally: Tally,
}

impl Trial {
    /// Of a scene, at t = 0.
    ///
    /// # Errors
    /// Where the scene is not sound.
    pub(super) fn start(scene: &Scene) -> Result<Self> {
        Ok(Self { simulation: scene.simulation()?, tally: Tally::default() })
    }

    /// Steps until a simulated time (s); `after` is called after each step.
    ///
    /// # Errors
    /// Where the state is no longer finite.
    pub(super) fn run_until(
        &mut self,
        secs: f64,
        mut after: impl FnMut(&mut Simulation),
    ) -> Result<()> {
        while self.simulation.observables().step < self.simulation.step_at(secs) {
            self.simulation.step()?;
            self.tally.add(self.simulation.observables());
            after(&mut self.simulation);
        }
        Ok(())
    }

    /// What the run comes to, with what it was run for.
    pub(super) fn measured<const COUNT: usize>(
        &self,
        readings: [(&'static str, f64); COUNT],
    ) -> Measured {
        let reading = |(name, value): (&str, f64)| Reading { name: name.to_owned(), value };
        Measured {
            readings: readings.into_iter().map(reading).collect(),
            simulated_secs: self.simulation.time_secs(),
            steps: self.tally.steps,
            unsolved_steps: self.tally.unconverged_steps,
            lost_grains: self.simulation.observables().lost_grains,
            blew_up: false,
        }
    }
}
