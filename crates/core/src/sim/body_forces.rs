//! Body forces: external forces on the grains in addition to gravity, which act until the caller replaces them.

use glam::DVec2;

use crate::error::Result;
use crate::sim::simulation::Simulation;

impl Simulation {
    /// Returns the body force on each grain (in addition to gravity), N; empty if no grain has such a force.
    pub fn body_forces(&self) -> &[DVec2] {
        &self.state.body_forces
    }

    /// Sets a body force on each grain in addition to gravity, N. The forces act from the next step on until they are
    /// replaced. Their work is part of the observable `gravity_work`. A grain added later has no body force.
    ///
    /// # Errors
    /// The error says why `forces` are not valid: their number differs from the number of grains, a force is not
    /// finite, or a force acts along y in a scene with one axis. The forces are then unchanged.
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
