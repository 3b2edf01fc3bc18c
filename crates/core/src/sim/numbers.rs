//! What the numbers of a simulation's settings come to in its world.

use crate::sim::Settings;
use crate::sim::settings::FractureWork;
use crate::sim::simulation::Simulation;
use crate::solver::{Method, picked};

impl Simulation {
    /// Substeps of the next step: 1 where its problem is solved as a whole.
    pub fn substeps(&self) -> u32 {
        let Settings { stepper, parameters, .. } = &self.settings;
        (stepper.info().substeps)(&self.state.world, self.state.physics, parameters)
    }

    /// The method that solves the next step: that of the settings, or the one that `auto` picks.
    pub fn picked_method(&self) -> Method {
        let Settings { solver, parameters, .. } = &self.settings;
        let rubs = self.state.physics.friction && parameters.friction > 0.0;
        picked(solver, solver.friction_model, rubs, self.is_driven())
    }

    fn is_driven(&self) -> bool {
        self.state.world.motions.iter().any(|motion| motion.drive.is_some())
    }

    /// The longest substep, s, with which the springs of the next step are surely stable; none
    /// where there are no springs.
    pub fn critical_time_step_secs(&self) -> Option<f64> {
        let Settings { stepper, parameters, .. } = &self.settings;
        (stepper.info().critical_time_step_secs)(&self.state.world, self.state.physics, parameters)
    }

    /// How long two grains of the mean mass that meet push each other, s; none where contacts are no springs.
    pub fn contact_time_secs(&self) -> Option<f64> {
        let Settings { stepper, parameters, .. } = &self.settings;
        (stepper.info().contact_time_secs)(&self.state.world, self.state.physics, parameters)
    }

    /// What it takes to break the bond of two grains of the mean mass slowly; none where the law does not say, or
    /// nothing coheres.
    pub fn fracture_work(&self) -> Option<FractureWork> {
        let Settings { stepper, parameters, .. } = &self.settings;
        (stepper.info().fracture_work)(&self.state.world, self.state.physics, parameters)
    }
}
