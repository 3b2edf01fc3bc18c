//! Constants that the calculation of shocks (collisions) and bonds needs in a step under the contact law `range`.

use crate::contact::range::TOUCH_IN_DIAMETERS;
use crate::sim::settings::Settings;
use crate::world::{Parameters, World};

/// Constants that the calculation of shocks (collisions) and bonds needs in a step: parameters, time step and lengths
/// in metres.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct StepNumbers {
    pub parameters: Parameters,
    pub time_step_secs: f64,
    /// Debonding distance δ_c, m: the stretch at which a bond breaks.
    pub debonding_distance: f64,
    /// Gap, m, up to which a pair counts as touching: [`TOUCH_IN_DIAMETERS`] mean diameters. The setting
    /// `touch-tolerance` does not change it.
    pub touch: f64,
    /// Gravitational acceleration g, m/s².
    gravity_magnitude: f64,
}

impl StepNumbers {
    /// Computes the constants of a step with these settings.
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

    /// Returns the term ρ u, m/s, that is added to the normal velocity of a contact in the law of collisions, with the
    /// coefficient of restitution ρ. `closing` is the normal velocity u before the collision, m/s, below 0. The term is
    /// 0 if the contact closes more slowly than `restitution_threshold` times the speed that gravity adds in a step.
    pub(super) fn rebound(&self, closing: f64) -> f64 {
        self.parameters.restitution_velocity(closing, self.gravity_magnitude)
    }
}
