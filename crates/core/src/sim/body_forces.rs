//! Forces on the grains from outside, beside gravity: held until they are set anew.

use glam::DVec2;

use crate::error::Result;
use crate::sim::pull::Push;
use crate::sim::simulation::Simulation;
use crate::sim::state::State;

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

impl State {
    /// What pushes grains from outside in the next `secs`: a spring, and body forces.
    pub(super) fn pushes(&self, axes: usize, secs: f64) -> Vec<Push> {
        let masses = &self.world.grains.masses;
        let spring = self.pull.and_then(|pull| pull.push(&self.world, axes, secs));
        let forces = self.body_forces.iter().zip(masses).enumerate();
        let forces =
            forces.filter_map(|(grain, (&force, mass))| Push::of(grain, secs / mass * force));
        spring.into_iter().chain(forces).collect()
    }

    /// The largest acceleration of a grain by gravity and body forces, m/s²: the next step looks for contacts as far as that
    /// may lead.
    pub(super) fn largest_acceleration(&self) -> f64 {
        let forces = self.body_forces.iter().zip(&self.world.grains.masses);
        let largest = forces.map(|(force, mass)| force.length() / mass).fold(0.0, f64::max);
        self.world.gravity.magnitude() + largest
    }
}
