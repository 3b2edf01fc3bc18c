//! Works of fracture: what runs under the laws that have one amount to, and what stands for it under `moreau`.

use super::super::paired::Paired;
use super::super::workshop::Rows;
use crate::config::{Config, SceneSource};
use crate::error::{Error, Result};
use crate::scene::Scene;
use crate::sim::Stepper;

/// Grains of a pile of the study.
const GRAINS: usize = 138;

/// A Bond and a work of fracture under both laws that have one.
pub(super) struct Level<'a> {
    pub bond: f64,
    /// Of `range` and of `dem`, in m g d.
    pub works: [f64; 2],
    pub runs: Paired<'a>,
}

impl Level<'_> {
    /// Slumps under a law: 0 is `range`, 1 `dem`.
    pub(super) fn slumps(&self, law: usize) -> Vec<f64> {
        let Paired { reference, other, .. } = &self.runs;
        [reference, other][law].outcomes(|outcome| outcome.slump)
    }
}

/// The scene of a run, but for its grains, which are those of the shipped state.
fn scene(config: &Config) -> Result<Scene> {
    let source = SceneSource { seed: None, ..config.source.clone() };
    Config { source, ..config.clone() }.without_settling()
}

/// The work of fracture of some runs, in m g d.
fn work(rows: &Rows<'_>) -> Result<f64> {
    let none = || Error::value("cohesion", "without a run", "a study with all its runs");
    let (config, _) = rows.0.first().ok_or_else(none)?;
    let work = scene(config)?.simulation()?.fracture_work();
    work.map(|work| work.over_mgd).ok_or_else(none)
}

/// Every Bond with every work, rising.
pub(super) fn levels<'a>(rows: &Rows<'a>) -> Result<Vec<Level<'a>>> {
    let mut all = Vec::new();
    for bond in rows.values(|config| config.parameters.bond) {
        let of = |law| {
            rows.such_that(|config| {
                config.parameters.bond == Some(bond) && config.stepper == Some(law)
            })
        };
        let (range, dem) = (of(Stepper::Range), of(Stepper::Dem));
        let distances = range.values(|config| config.parameters.debonding_distance);
        // The softer, the more work.
        let stiffnesses = dem.values(|config| config.parameters.stiffness).into_iter().rev();
        for (distance, stiffness) in distances.into_iter().zip(stiffnesses) {
            let reference =
                range.such_that(|config| config.parameters.debonding_distance == Some(distance));
            let other = dem.such_that(|config| config.parameters.stiffness == Some(stiffness));
            let works = [work(&reference)?, work(&other)?];
            all.push(Level { bond, works, runs: Paired { grains: GRAINS, reference, other } });
        }
    }
    Ok(all)
}

/// Runs of a Bond and a Δt under `moreau`.
pub(super) struct Captured {
    pub bond: f64,
    /// The energy that a step takes up, in m g d.
    pub energy: f64,
    pub slumps: Vec<f64>,
}

/// Every Bond with every Δt.
pub(super) fn captured(rows: &Rows<'_>) -> Result<Vec<Captured>> {
    let moreau = rows.such_that(|config| config.stepper == Some(Stepper::Moreau));
    let mut all = Vec::new();
    for bond in moreau.values(|config| config.parameters.bond) {
        let here = moreau.such_that(|config| config.parameters.bond == Some(bond));
        for step in here.values(|config| config.parameters.time_step_secs) {
            let here = here.such_that(|config| config.parameters.time_step_secs == Some(step));
            let scene = scene(here.0[0].0)?;
            let g = scene.gravity.magnitude();
            let speed = scene.parameters.capture_speed(g);
            // Of two equal grains m_ij is m/2.
            let energy = 0.25 * speed * speed / (g * scene.mean_diameter);
            let slumps = here.outcomes(|outcome| outcome.slump);
            all.push(Captured { bond, energy, slumps });
        }
    }
    Ok(all)
}
