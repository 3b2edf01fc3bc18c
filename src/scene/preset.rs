//! Settings that go together.

use serde::{Deserialize, Serialize};

use super::Scene;
use crate::solver::{Method, Remedies, SolverSettings, StopTest};
use crate::world::Parameters;

/// Gap below which grains touch, in d: contacts that a step opens by its rounding live on.
const GAP_TOLERANCE: f64 = 1e-3;
/// Contacts slower than this many g·Δt do not bounce: nearly every step then has a solution.
const RESTITUTION_THRESHOLD: f64 = 2.0;
/// Residual that steps are solved to.
const TOLERANCE: f64 = 1e-8;
const MAX_SWEEPS: u32 = 5_000;
/// Furthest way of a grain in a piece of a step, in d: half of what could jump a wall.
const MAX_TRAVEL: f64 = 0.25;

/// Each for a failure of its own. Fast grains are cut into pieces of a step and not looked ahead for,
/// which would cost them their bounce (`sim::speculative`).
const ALL_REMEDIES: Remedies = Remedies {
    push_out: true,
    max_travel: MAX_TRAVEL,
    calm_unsolved: true,
    sequential_impacts: true,
    speculative: false,
};

/// Settings that go together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Preset {
    /// Every known remedy: hard scenes hold, and the paper's effects of the time step are gone.
    Robust,
}

impl Preset {
    /// Changes a scene.
    pub fn apply(self, scene: &mut Scene) {
        scene.gap_tolerance = scene.gap_tolerance.max(GAP_TOLERANCE * scene.mean_diameter);
        self.apply_to_settings(&mut scene.parameters, &mut scene.solver);
    }

    /// Changes what can be changed during a run.
    pub fn apply_to_settings(self, parameters: &mut Parameters, solver: &mut SolverSettings) {
        let Self::Robust = self;
        parameters.restitution_threshold =
            parameters.restitution_threshold.max(RESTITUTION_THRESHOLD);
        *solver = SolverSettings {
            method: Method::Newton,
            stop: StopTest::Residual,
            tolerance: TOLERANCE,
            max_sweeps: MAX_SWEEPS,
            warm_start: true,
            remedies: ALL_REMEDIES.under(parameters.law),
            ..*solver
        };
    }
}
