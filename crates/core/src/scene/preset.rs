//! Presets: groups of settings that are set together.

use super::Scene;
use crate::setting::{Group, words};
use crate::sim::{REMEDIES, Remedies, Settings};
use crate::solver::{Method, SolverSettings, StopTest};
use crate::world::RESTITUTION_THRESHOLD;

/// Touch tolerance (largest gap at which grains touch) of the preset (group of settings) `robust`, in mean diameters.
/// If the errors of a step open a contact by less than this length, the two grains still touch.
const TOUCH_TOLERANCE: f64 = 1e-3;
/// Tolerance of the solver in the preset (group of settings) `robust`: largest residual of a solved step.
const TOLERANCE: f64 = 1e-8;
/// Largest number of sweeps of the solver per step in the preset (group of settings) `robust`.
const MAX_SWEEPS: u32 = 5_000;

words! {
    /// A group of settings that are set together.
    pub enum Preset {
        Paper = "paper", "The scheme of the paper's figures: Gauss-Seidel to a relative change of 1e-7, touch \
            tolerance 0, restitution at every speed";
        Robust = "robust", "Newton's method and remedies together: most hard scenes pass, and the paper's effect of \
            the time step is gone";
    }
}

impl Preset {
    /// Sets the settings of a scene to those of this preset (group of settings).
    pub fn apply(self, scene: &mut Scene) {
        let mut settings = scene.settings();
        self.apply_to_settings(&mut settings);
        scene.set_settings(settings);
    }

    /// Sets those settings that can change during a run to the values of this preset (group of settings).
    pub fn apply_to_settings(self, settings: &mut Settings) {
        match self {
            Self::Paper => {
                settings.parameters.touch_tolerance = 0.0;
                settings.parameters.restitution_threshold = 0.0;
                // A scene with solver settings of its own demonstrates a particular scheme, so these settings stay.
                if settings.solver == SolverSettings::default() {
                    settings.solver = SolverSettings::PAPER;
                    *settings = settings.with_only_what_is_taken();
                }
            }
            Self::Robust => make_robust(settings),
        }
    }
}

fn make_robust(settings: &mut Settings) {
    let threshold = &mut settings.parameters.restitution_threshold;
    *threshold = threshold.max(RESTITUTION_THRESHOLD);
    let tolerance = &mut settings.parameters.touch_tolerance;
    *tolerance = tolerance.max(TOUCH_TOLERANCE);
    settings.solver = SolverSettings {
        method: Method::Newton,
        stop: StopTest::Residual,
        tolerance: TOLERANCE,
        max_sweeps: MAX_SWEEPS,
        warm_start: true,
        ..settings.solver
    };
    settings.remedies = Remedies::default();
    for remedy in &REMEDIES {
        if let Some(value) = remedy.robust {
            settings.remedies.set(remedy.name, value);
        }
    }
    *settings = settings.with_only_what_is_taken();
}
