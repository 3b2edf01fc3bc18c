//! Presets: settings that are used together.

use super::Scene;
use crate::setting::{Group, words};
use crate::sim::{REMEDIES, Remedies, Settings};
use crate::solver::{Method, SolverSettings, StopTest};

/// Touch tolerance, in d, so that contacts opened by the errors of a step stay in touch.
const TOUCH_TOLERANCE: f64 = 1e-3;
/// Contacts slower than this many g·Δt do not bounce. Nearly every step then has a solution.
const RESTITUTION_THRESHOLD: f64 = 2.0;
/// Tolerance on the residual of each step.
const TOLERANCE: f64 = 1e-8;
const MAX_SWEEPS: u32 = 5_000;

words! {
    /// A group of settings that are used together.
    pub enum Preset {
        Paper = "paper", "The scheme of the paper's figures: Gauss-Seidel to a relative change of 1e-7, touch tolerance 0";
        Robust = "robust", "Newton's method and remedies together: most hard scenes pass, and the paper's effect of \
            the time step is gone";
    }
}

impl Preset {
    /// Changes the settings of a scene.
    pub fn apply(self, scene: &mut Scene) {
        let mut settings = scene.settings();
        self.apply_to_settings(&mut settings);
        scene.set_settings(settings);
    }

    /// Changes the settings that can change during a run.
    pub fn apply_to_settings(self, settings: &mut Settings) {
        match self {
            Self::Paper => {
                settings.parameters.touch_tolerance = 0.0;
                // A scene with its own solver settings demonstrates a particular scheme.
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
