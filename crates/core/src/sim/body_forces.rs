//! External forces on the grains in addition to gravity. They act until they are replaced.

use glam::DVec2;

use crate::error::Result;
use crate::sim::simulation::Simulation;

impl Simulation {
    /// The force on each grain in addition to gravity, N; empty if none were set.
    pub fn body_forces(&self) -> &[DVec2] {
        &self.state.body_forces
    }

    /// Sets a force on each grain in addition to gravity, N. It acts from the next step on until it is replaced, and
    /// its work is part of `gravity_work`. A grain added later has no such force.
    ///
    /// # Errors
    /// Same as [`Simulation::set_positions`].
    pub fn set_body_forces(&mut self, forces: &[DVec2]) -> Result<()> {
        let mut held = vec![DVec2::ZERO; self.state.world.grains.len()];
        self.replace("body_forces", &mut held, forces)?;
        if held.iter().all(|&force| force == DVec2::ZERO) {
            held.clear();
        }
        self.state.body_forces = held;
        Ok(())
    }
}
