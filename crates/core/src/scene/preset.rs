//! Settings that go together.

use super::Scene;
use crate::setting::{Group, words};
use crate::sim::{REMEDIES, Remedies, Settings};
use crate::solver::{Method, SolverSettings, StopTest};

/// Touch tolerance, in d: contacts that a step opens by its errors stay in touch.
const TOUCH_TOLERANCE: f64 = 1e-3;
/// Contacts slower than this many g·Δt do not bounce: nearly every step then has a solution.
const RESTITUTION_THRESHOLD: f64 = 2.0;
/// Residual that steps are solved to.
const TOLERANCE: f64 = 1e-8;
const MAX_SWEEPS: u32 = 5_000;

words! {
    /// Settings that go together.
    pub enum Preset {
        Paper = "paper", "The scheme of the paper's figures: Gauss-Seidel to a relative change of 1e-7, touch tolerance 0";
        Robust = "robust", "Newton's method and remedies together: most hard scenes pass, and the paper's effect of the time step is gone";
    }
}

impl Preset {
    /// Changes a scene.
    pub fn apply(self, scene: &mut Scene) {
        let mut settings = scene.settings();
        self.apply_to_settings(&mut settings);
        scene.set_settings(settings);
    }

    /// Changes what can be changed during a run.
    pub fn apply_to_settings(self, settings: &mut Settings) {
        match self {
            Self::Paper => {
                settings.parameters.touch_tolerance = 0.0;
                // A scene that says how it is solved shows a scheme of its own.
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
