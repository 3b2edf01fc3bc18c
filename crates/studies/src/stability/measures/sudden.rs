//! Sudden changes: a grain taken away, another time step, and every slider at random.

use glam::DVec2;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::error::Result;
use crate::scene::stability::{heap, lift_off as lift_off_of};
use crate::sim::Pull;
use crate::stability::trial::{Trial, unrest};
use crate::world::{Boundary, Parameters};

/// Steps before a sudden change, and after it.
const BEFORE: u64 = 50;
const AFTER: u64 = 30;
/// Time step before it is switched, s.
const SMALL_STEP_SECS: f64 = 2e-4;
/// Rows of the heaps.
const ROWS: usize = 4;
/// Half the side of the box around the heap, in d.
const BOX: f64 = 12.0;
/// Simulated time between two changes of the sliders, s.
const CHANGE_SECS: f64 = 0.05;
/// Sweeps of a step while the sliders move: a window has to keep up.
const LIVE_SWEEPS: u32 = 200;

/// Largest kinetic energy after a heavy disc is taken off a column, over m g d of one of its discs.
pub(crate) fn lift_off(trial: &Trial) -> Result<f64> {
    let mut simulation = trial.start(lift_off_of(trial.level))?;
    simulation.take_steps(BEFORE)?;
    let last = simulation.world().grains.len() - 1;
    simulation.remove_grain(last)?;
    let world = simulation.world();
    let scale = world.grains.masses[0] * world.gravity.magnitude() * world.mean_diameter;
    let mut energy = 0f64;
    for _ in 0..AFTER {
        energy = energy.max(simulation.step()?.kinetic_energy / scale);
    }
    Ok(energy)
}

/// A heap at rest whose time step grows: the longest way of any grain, in d, or the speed that is
/// left, in √(g d), whichever is larger.
pub(crate) fn time_step_switch(trial: &Trial) -> Result<f64> {
    let mut scene = heap(ROWS);
    scene.parameters.time_step_secs = SMALL_STEP_SECS;
    let mut simulation = trial.start(scene.clone())?;
    simulation.take_steps(BEFORE)?;
    let time_step_secs = SMALL_STEP_SECS * trial.level;
    simulation.set_parameters(Parameters { time_step_secs, ..*simulation.parameters() })?;
    simulation.take_steps(AFTER)?;
    Ok(unrest(&simulation, &scene))
}

/// Grains that have left their box after so many seconds with every slider moved at random, and a
/// hand that pulls at grains.
pub(crate) fn sliders(trial: &Trial) -> Result<f64> {
    let mut scene = heap(ROWS);
    scene.solver.max_sweeps = LIVE_SWEEPS;
    let half = BOX * scene.mean_diameter;
    let wall = |normal: DVec2| Boundary::HalfSpace { point: -half * normal, normal };
    scene.boundaries = [DVec2::X, -DVec2::X, DVec2::Y, -DVec2::Y].map(wall).into();
    let radius = scene.grains[0].radius;
    let mut simulation = trial.start(scene)?;
    let mut random = Pcg64::seed_from_u64(3);
    let mut next_secs = 0.0;
    while simulation.time_secs() < trial.level {
        if simulation.time_secs() >= next_secs {
            next_secs += CHANGE_SECS;
            let before = *simulation.parameters();
            simulation.set_parameters(Parameters {
                bond: random.random_range(0.0..200.0),
                time_step_secs: 10f64.powf(random.random_range(-4.0..-1.5)),
                restitution: random.random_range(0.0..=1.0),
                friction: random.random_range(0.0..1.0),
                ..before
            })?;
            let mut place = || 2.0 * half * random.random_range(-1.0..1.0);
            let target = DVec2::new(place(), place());
            let grain = random.random_range(0..simulation.world().grains.len() as u32);
            simulation.set_pull(Some(Pull { grain, target }));
        }
        simulation.step()?;
    }
    let inside = |place: &&DVec2| place.abs().max_element() < half + radius;
    let positions = &simulation.world().grains.positions;
    Ok((positions.len() - positions.iter().filter(inside).count()) as f64)
}
