//! Parameters of a step under the law `range`.

use crate::contact::range::TOUCH_IN_DIAMETERS;
use crate::sim::settings::Settings;
use crate::world::{Parameters, World};

/// Parameters of a step that its shocks and bonds need.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct StepNumbers {
    pub parameters: Parameters,
    pub time_step_secs: f64,
    /// δ_c, m.
    pub debonding_distance: f64,
    /// Gaps below this count as zero, m.
    pub touch: f64,
    /// g, m/s².
    gravity_magnitude: f64,
}

impl StepNumbers {
    /// The parameters of a step with these settings.
    pub(super) fn of(world: &World, settings: &Settings) -> Self {
        let parameters = settings.parameters;
        Self {
            parameters,
            time_step_secs: parameters.time_step_secs,
            debonding_distance: parameters.debonding_distance * world.mean_diameter,
            touch: TOUCH_IN_DIAMETERS * world.mean_diameter,
            gravity_magnitude: world.gravity.magnitude(),
        }
    }

    /// ρ u, m/s, of a contact that closes with u, or 0 below the threshold.
    pub(super) fn rebound(&self, closing: f64) -> f64 {
        self.parameters.restitution_velocity(closing, self.gravity_magnitude)
    }
}
