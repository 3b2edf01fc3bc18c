//! Contact laws with a prescribed work to break a bond.

use crate::scene::Scene;
use crate::sim::{Settings, Stepper};

/// The work, J, that slowly breaks a bond of two mean grains of a scene under these settings; `None` if the law does
/// not define it, or if there is no attraction.
pub(super) fn fracture_work(scene: &Scene, settings: Settings) -> Option<f64> {
    let mut scene = scene.clone();
    scene.set_settings(settings);
    Some(scene.simulation().ok()?.fracture_work()?.joules).filter(|joules| *joules > 0.0)
}

/// Settings under which this work is `joules`, by the debonding distance of `range` or the stiffness of `dem`. Settings
/// of other steppers, or without attraction, are returned unchanged.
pub(super) fn with_fracture_work(scene: &Scene, mut settings: Settings, joules: f64) -> Settings {
    match settings.stepper {
        Stepper::Dem => {
            // W = C₀²/2k: the work at a stiffness of 1 N/m gives k.
            let mut of_one = settings;
            of_one.parameters.stiffness = 1.0;
            if let Some(of_one) = fracture_work(scene, of_one) {
                settings.parameters.stiffness = of_one / joules;
            }
        }
        Stepper::Range => {
            // W = C₀ δc.
            let of_this = fracture_work(scene, settings).unwrap_or(joules);
            settings.parameters.debonding_distance *= joules / of_this;
        }
        _ => {}
    }
    settings
}
