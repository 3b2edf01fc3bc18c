//! Very many contacts at rest, and few sweeps.

use crate::error::Result;
use crate::scene::Scene;
use crate::scene::stability::{heap_of, lattice};
use crate::sim::Simulation;
use crate::stability::trial::{Trial, unrest};

/// Sweeps of a step, or iterations of a method without sweeps: what a window has time for.
const SWEEPS: u32 = 40;
/// Steps from a start without impulses. In free fall, a grain would go 0.2 d.
const STEPS: u64 = 20;
/// Discs in every other row of the lattice, and its rows: 3,900 contacts.
const LATTICE: [usize; 2] = [37, 36];

/// What is left of motion in a lattice, or the common residual of the last step, whichever is larger.
pub(crate) fn hyperstatic(trial: &Trial) -> Result<f64> {
    let [columns, rows] = LATTICE;
    let scene = lattice(columns, rows, trial.level);
    let simulation = settled(trial, &scene)?;
    Ok(unrest(&simulation, &scene).max(simulation.observables().residual))
}

/// What is left of motion in a heap of so many grains.
pub(crate) fn size(trial: &Trial) -> Result<f64> {
    let scene = heap_of(trial.count());
    Ok(unrest(&settled(trial, &scene)?, &scene))
}

fn settled(trial: &Trial, scene: &Scene) -> Result<Simulation> {
    let mut simulation = trial.start_within(SWEEPS, scene.clone())?;
    simulation.take_steps(STEPS)?;
    Ok(simulation)
}
