//! Columns: what the floor carries, and how far the top sinks. A step that is not solved to its end
//! leaves a speed, so a column sinks as if its discs were soft: the fake elasticity of an
//! unconverged solver.

use crate::error::Result;
use crate::scene::Scene;
use crate::scene::stability::{self, column as column_of, logs};
use crate::sim::Simulation;
use crate::stability::trial::{Trial, advance, force_on_ground};

/// Simulated time of these runs, s.
const DURATION_SECS: f64 = 0.1;
/// Sweeps of a step, unless they are what is varied: few, as in a window that has to keep up.
const FEW_SWEEPS: u32 = 100;
/// Discs of the column whose sag is measured.
pub(in crate::stability) const SAGGING_DISCS: usize = 20;

/// Greatest error of the floor's force in the last quarter of the run, over the weight.
pub(crate) fn column(trial: &Trial) -> Result<f64> {
    let mut scene = column_of(trial.count());
    scene.solver.max_sweeps = FEW_SWEEPS;
    let mut simulation = trial.start(scene)?;
    let world = simulation.world();
    let weight = world.grains.masses.iter().sum::<f64>() * world.gravity.magnitude();
    advance(&mut simulation, 0.75 * DURATION_SECS)?;
    let mut worst = 0f64;
    for _ in 0..simulation.parameters().steps_in(0.25 * DURATION_SECS) {
        simulation.step()?;
        worst = worst.max((force_on_ground(&simulation) / weight - 1.0).abs());
    }
    Ok(worst)
}

/// A column whose steps get `sweeps` sweeps each (or substeps), from nothing.
pub(in crate::stability) fn sagging(count: usize, sweeps: u32) -> Scene {
    let mut scene = column_of(count);
    scene.solver.max_sweeps = sweeps;
    scene.parameters.substeps = sweeps;
    scene.solver.tolerance = 1e-12;
    scene.solver.warm_start = false;
    scene
}

/// How far the top of a column sinks, in d.
pub(crate) fn sag(trial: &Trial) -> Result<f64> {
    sunk_in(trial, &sagging(SAGGING_DISCS, trial.count() as u32))
}

/// How far a heavy disc on a light one sinks, in d.
pub(crate) fn mass_ratio(trial: &Trial) -> Result<f64> {
    let mut scene = stability::mass_ratio(trial.level);
    scene.solver.max_sweeps = FEW_SWEEPS;
    sunk_in(trial, &scene)
}

/// How far a large disc on two small ones sinks, in d.
pub(crate) fn size_ratio(trial: &Trial) -> Result<f64> {
    let mut scene = logs(trial.level);
    scene.solver.max_sweeps = FEW_SWEEPS;
    sunk_in(trial, &scene)
}

fn sunk_in(trial: &Trial, scene: &Scene) -> Result<f64> {
    let mut simulation = trial.start(scene.clone())?;
    advance(&mut simulation, DURATION_SECS)?;
    Ok(sunk(&simulation, scene))
}

/// How far the last grain has moved since `scene`, in d.
pub(in crate::stability) fn sunk(simulation: &Simulation, scene: &Scene) -> f64 {
    let last = scene.grains.len() - 1;
    let [before, now] = [scene.grains[last].position, simulation.world().grains.positions[last]];
    before.distance(now) / scene.mean_diameter
}
