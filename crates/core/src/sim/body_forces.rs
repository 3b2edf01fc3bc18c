//! Forces on the grains from outside, beside gravity: held until they are set anew.

use glam::DVec2;

use crate::error::Result;
use crate::sim::simulation::Simulation;

impl Simulation {
    /// The force on each grain beside gravity, N; empty where none was set.
    pub fn body_forces(&self) -> &[DVec2] {
        &self.state.body_forces
    }

    /// Sets a force on each grain beside gravity, N. It acts from the next step on until it is set anew, and its work is part
    /// of `gravity_work`. A grain that is put in later has none.
    ///
    /// # Errors
    /// As [`Simulation::set_positions`].
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
