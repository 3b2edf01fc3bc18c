//! The numbers of a step under the law `range`.

use crate::contact::range::TOUCH_IN_DIAMETERS;
use crate::sim::settings::Settings;
use crate::world::World;

/// The numbers of a step that its bonds hang on.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepNumbers {
    pub time_step_secs: f64,
    /// ρ.
    pub restitution: f64,
    /// δ_c, m.
    pub debonding_distance: f64,
    /// Gaps below this are none, m.
    pub touch: f64,
}

impl StepNumbers {
    /// Those of a step with these settings.
    pub(super) fn of(world: &World, settings: &Settings) -> Self {
        let parameters = &settings.parameters;
        Self {
            time_step_secs: parameters.time_step_secs,
            restitution: parameters.restitution,
            debonding_distance: parameters.debonding_distance * world.mean_diameter,
            touch: TOUCH_IN_DIAMETERS * world.mean_diameter,
        }
    }
}
