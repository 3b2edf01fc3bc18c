//! Presets: settings that are used together.

use super::Scene;
use crate::setting::{Group, words};
use crate::sim::{REMEDIES, Remedies, Settings};
use crate::solver::{Method, SolverSettings, StopTest};

/// Gap below which grains touch, in d, so that contacts opened by rounding errors of a step survive.
const GAP_TOLERANCE: f64 = 1e-3;
/// Contacts slower than this many g·Δt do not bounce. Nearly every step then has a solution.
const RESTITUTION_THRESHOLD: f64 = 2.0;
/// Tolerance on the residual of each step.
const TOLERANCE: f64 = 1e-8;
const MAX_SWEEPS: u32 = 5_000;

words! {
    /// A group of settings that are used together.
    pub enum Preset {
        Paper = "paper", "The paper's scheme as its figures are computed: Gauss-Seidel to a relative change of 1e-7";
        Robust = "robust", "Remedies together: hard scenes hold, and the paper's effects of the time step are gone";
    }
}

impl Preset {
    /// Changes the settings of a scene.
    pub fn apply(self, scene: &mut Scene) {
        if self == Self::Robust {
            scene.gap_tolerance = scene.gap_tolerance.max(GAP_TOLERANCE * scene.mean_diameter);
        }
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
