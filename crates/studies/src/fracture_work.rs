//! Computes the work that breaks a cohesive bond between two grains, and finds settings with which breaking a bond
//! takes a prescribed work.

use crate::scene::Scene;
use crate::sim::{Settings, Stepper};

/// Returns the work, J, that is needed to break a bond slowly between two grains of mean size in a scene with these
/// settings. Returns `None` if the contact law does not define this work, or if there is no attraction.
pub(super) fn fracture_work(scene: &Scene, settings: Settings) -> Option<f64> {
    let mut scene = scene.clone();
    scene.set_settings(settings);
    Some(scene.simulation().ok()?.fracture_work()?.joules).filter(|joules| *joules > 0.0)
}

/// Returns changed settings, with which breaking a bond between two grains of mean size takes the work `joules`, J. For
/// the stepper `range` the debonding distance is changed, for the stepper `dem` the contact stiffness. For other
/// steppers, or without attraction, the settings are returned unchanged.
pub(super) fn with_fracture_work(scene: &Scene, mut settings: Settings, joules: f64) -> Settings {
    match settings.stepper {
        Stepper::Dem => {
            // The work is W = C₀²/(2k), with the cohesion force C₀ (N) and the stiffness k (N/m). So k is the work at 1
            // N/m divided by the prescribed work.
            let mut of_one = settings;
            of_one.parameters.stiffness = 1.0;
            if let Some(of_one) = fracture_work(scene, of_one) {
                settings.parameters.stiffness = of_one / joules;
            }
        }
        Stepper::Range => {
            // The work is W = C₀ δ_c, with the cohesion force C₀ (N) and the debonding distance δ_c (m).
            let of_this = fracture_work(scene, settings).unwrap_or(joules);
            settings.parameters.debonding_distance *= joules / of_this;
        }
        _ => {}
    }
    settings
}
