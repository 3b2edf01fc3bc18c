//! The settings that the window shows for the open scene, and the settings with a main slider (one of the most
//! prominent sliders): Bond, Δt, ρ and μ.

use glam::DVec2;

use crate::app::watched_run::WatchedRun;
use crate::setting::{About, Group, Needs};
use crate::sim::Settings;
use crate::world::Parameters;

/// Names of the settings that have a main slider: the Bond number, the time step Δt, the restitution coefficient ρ and
/// the friction coefficient μ.
pub const FRONT_SETTINGS: [&str; 4] = ["bond", "dt", "rho", "mu"];

/// Returns the settings of the contact law and of the time step that have an effect in the scene and that the stepper
/// uses.
pub(super) fn shown_settings(run: &WatchedRun, settings: &Settings) -> Vec<&'static About> {
    let Some(physics) = run.frame.start.as_ref().map(|start| start.physics()) else {
        return Vec::new();
    };
    let gravity = run.world().and_then(|world| world.gravity);
    let has_direction = physics.axes == 2 && gravity.is_some_and(|gravity| gravity != DVec2::ZERO);
    let is_shown = |about: &&About| {
        let has = match about.needs {
            Needs::Nothing => true,
            Needs::Friction => physics.friction,
            Needs::Rotation => physics.rotation,
            Needs::Cohesion => physics.cohesion,
            Needs::Direction => has_direction,
        };
        has && about.control.is_some() && settings.stepper.reads(about.name)
    };
    Parameters::ABOUT.iter().filter(is_shown).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_slider_of_the_front_is_a_declared_setting() {
        for name in FRONT_SETTINGS {
            let about = Parameters::ABOUT.iter().find(|about| about.name == name);
            assert!(about.is_some_and(|about| about.control.is_some()), "{name}");
        }
    }
}
