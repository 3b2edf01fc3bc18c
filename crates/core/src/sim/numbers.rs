//! Quantities that follow from the settings and the world of a simulation, such as the number of substeps (parts into
//! which a stepper divides a step).

use crate::sim::Settings;
use crate::sim::settings::FractureWork;
use crate::sim::simulation::Simulation;
use crate::solver::{Method, picked};

impl Simulation {
    /// Returns the number of substeps (equal parts) of the next step; 1 if the stepper solves the step as a whole.
    pub fn substeps(&self) -> u32 {
        let Settings { stepper, parameters, .. } = &self.settings;
        (stepper.info().substeps)(&self.state.world, self.state.physics, parameters)
    }

    /// Returns the solver of the next step: the solver of the settings, or the solver that `auto` selects.
    pub fn picked_method(&self) -> Method {
        let Settings { solver, parameters, .. } = &self.settings;
        let rubs = self.state.physics.friction
            && self.state.largest_friction(parameters).iter().any(|&it| it > 0.0);
        picked(solver, solver.friction_model, rubs, self.is_driven())
    }

    fn is_driven(&self) -> bool {
        self.state.world.motions.iter().any(|motion| motion.drive.is_some())
    }

    /// Returns the longest substep (part of a step), s, for which the contact springs of the next step are guaranteed
    /// to be stable; `None` if contacts are not springs.
    pub fn critical_time_step_secs(&self) -> Option<f64> {
        let Settings { stepper, parameters, .. } = &self.settings;
        (stepper.info().critical_time_step_secs)(&self.state.world, self.state.physics, parameters)
    }

    /// Returns the duration of a collision of two grains of the mean mass, s; `None` if contacts are not springs.
    pub fn contact_time_secs(&self) -> Option<f64> {
        let Settings { stepper, parameters, .. } = &self.settings;
        (stepper.info().contact_time_secs)(&self.state.world, self.state.physics, parameters)
    }

    /// Returns the work of fracture: the work needed to pull two bonded grains of the mean mass apart slowly. `None` if
    /// the contact law does not define it, or without cohesion.
    pub fn fracture_work(&self) -> Option<FractureWork> {
        let Settings { stepper, parameters, .. } = &self.settings;
        (stepper.info().fracture_work)(&self.state.world, self.state.physics, parameters)
    }
}
