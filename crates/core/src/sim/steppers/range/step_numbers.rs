//! Constants that the shocks and bonds of a step under the law `range` need.

use crate::contact::range::TOUCH_IN_DIAMETERS;
use crate::sim::settings::Settings;
use crate::world::{Parameters, World};

/// Constants that the shocks and bonds of a step need: parameters, time step and lengths in metres.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct StepNumbers {
    pub parameters: Parameters,
    pub time_step_secs: f64,
    /// Debonding distance δ_c, m: the stretch at which a bond breaks.
    pub debonding_distance: f64,
    /// Touch tolerance, m: smaller gaps count as zero.
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

    /// Returns the term ρ u (restitution ρ) that the law of a shock adds to the normal velocity of a contact, m/s.
    /// `closing` is the normal velocity u before the shock, below 0. The term is 0 for shocks slower than the
    /// restitution threshold.
    pub(super) fn rebound(&self, closing: f64) -> f64 {
        self.parameters.restitution_velocity(closing, self.gravity_magnitude)
    }
}
