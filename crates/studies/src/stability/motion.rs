//! Measures the errors of stability tests with moving grains: sliding friction, impacts, sudden changes, and changes
//! that must not affect the result (a shift of the scene, another numbering of the grains). Each function runs a trial
//! (one solver variant at one difficulty) and returns an error that is 0 for the right answer.

use glam::DVec2;
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::{Trial, advance, energy_scale, unrest};
use crate::error::Result;
use crate::scene::Scene;
use crate::scene::stability as scenes;
use crate::sim::{Pull, Simulation};
use crate::world::{Boundary, Parameters};

// Sliding friction must not lift a disc, and must follow a change of pressure at once.

/// Duration of the test of a sliding disc, as a multiple of the time after which friction should have stopped the disc.
const WATCHED: f64 = 1.2;
/// Duration of the test in which two sliding discs are hit from above, s.
const BLOW_SECS: f64 = 0.1;

/// Returns the larger of two errors of a disc that slides until friction stops it: the largest change of its height, in
/// diameters, and the relative error of its sliding distance. From the second error, half the distance of the first
/// step is subtracted, because correct time stepping schemes may differ by this distance.
pub(super) fn dilatancy(trial: &Trial) -> Result<f64> {
    let mut scene = scenes::dilatancy();
    scene.parameters.time_step_secs = trial.level;
    let [start, velocity] = [scene.grains[0].position, scene.grains[0].velocity];
    let slowing = scene.parameters.friction * scene.gravity.magnitude();
    let right = velocity.x.powi(2) / (2.0 * slowing);
    let mut simulation = trial.start(scene)?;
    let diameter = simulation.world().mean_diameter;
    let mut off_level = 0f64;
    while simulation.time_secs() < WATCHED * velocity.x / slowing {
        simulation.step()?;
        let height = simulation.world().grains.positions[0].y - start.y;
        off_level = off_level.max(height.abs() / diameter);
    }
    let way = simulation.world().grains.positions[0].x - start.x;
    let beyond = ((way - right).abs() - 0.5 * velocity.x * trial.level).max(0.0);
    Ok(off_level.max(beyond / right))
}

/// Returns the larger of two errors of two discs that slide on the floor and are hit from above. The first is the error
/// of their position along the floor, in diameters. It arises if the friction follows the increased pressure too late
/// or too early. The second is the error of their final speed, divided by the speed that the blow takes away.
pub(super) fn blow(trial: &Trial) -> Result<f64> {
    let mut scene = scenes::blow();
    scene.parameters.time_step_secs = trial.level;
    let friction = scene.parameters.friction;
    let mut simulation = trial.start(scene)?;
    let mass: f64 = simulation.world().grains.masses.iter().sum();
    let momentum = |simulation: &Simulation| {
        let grains = &simulation.world().grains;
        grains.masses.iter().zip(&grains.velocities).map(|(m, v)| *m * *v).sum::<DVec2>()
    };
    let start = momentum(&simulation);
    let (mut off, mut furthest) = (0f64, 0f64);
    while simulation.time_secs() < BLOW_SECS {
        let before_secs = simulation.time_secs();
        simulation.step()?;
        let now = momentum(&simulation);
        // The total impulse of the floor on the discs so far, N·s.
        let pushed = now.y - start.y;
        let left = (now.x - (start.x - friction * pushed)) / mass;
        off += left * (simulation.time_secs() - before_secs);
        furthest = furthest.max(off.abs());
    }
    let taken = friction * -start.y / mass;
    let right = start.x / mass - taken;
    let error = (momentum(&simulation).x / mass - right).abs() / taken;
    Ok(error.max(furthest / simulation.world().mean_diameter))
}

// Impacts: bounces of a disc, rows of balls, and walls that a disc can jump over in one step.

/// Number of runs in the test of a disc that flies against a thin wall. The runs differ in the phase: the time within a
/// step at which the disc reaches the wall.
const PHASES: u32 = 10;
/// Simulated time of the test of Newton's cradle, s, after which the speed of the last ball is measured.
const AFTER_SECS: f64 = 0.1;

/// Returns the larger of two errors of a bouncing disc. The first is the error of the height of the first bounce,
/// divided by the height of the fall. The second depends on the restitution ρ: for ρ < 1 it is the speed after the time
/// in which all bounces should have ended, divided by the speed of the first impact; for ρ = 1 it is the relative error
/// of the energy after ten times the duration of the fall.
pub(super) fn bounce(trial: &Trial) -> Result<f64> {
    let restitution = trial.level;
    let scene = scenes::bounce(restitution);
    let radius = scene.grains[0].radius;
    let drop = scene.grains[0].position.y - radius;
    let gravity = scene.gravity.magnitude();
    let fall_secs = (2.0 * drop / gravity).sqrt();
    let end_secs = if restitution < 1.0 {
        fall_secs * ((1.0 + restitution) / (1.0 - restitution) + 1.0)
    } else {
        10.0 * fall_secs
    };
    let mut simulation = trial.start(scene)?;
    let (mut touched, mut bounces, mut highest) = (false, 0, 0f64);
    while simulation.time_secs() < end_secs {
        let touches = simulation.step()?.contacts > 0;
        bounces += u32::from(touches && !touched);
        touched = touches;
        if bounces == 1 {
            highest = highest.max(simulation.world().grains.positions[0].y - radius);
        }
    }
    let first = (highest / drop - restitution * restitution).abs();
    let grains = &simulation.world().grains;
    let speed = grains.velocities[0].length();
    let last = if restitution < 1.0 {
        speed / (gravity * fall_secs)
    } else {
        let height = grains.positions[0].y - radius;
        ((0.5 * speed * speed + gravity * height) / (gravity * drop) - 1.0).abs()
    };
    Ok(first.max(last))
}

/// Returns the relative error of the speed of the last ball in Newton's cradle after the impact. The ball should have
/// the speed that the first ball had before.
pub(super) fn newtons_cradle(trial: &Trial) -> Result<f64> {
    let scene = scenes::balls(trial.count());
    let right = scene.grains[0].velocity.x;
    let mut simulation = trial.start(scene)?;
    advance(&mut simulation, AFTER_SECS)?;
    let velocities = &simulation.world().grains.velocities;
    Ok((velocities[velocities.len() - 1].x / right - 1.0).abs())
}

/// Returns the fraction of runs in which a fast disc goes through a thin wall. The runs differ in the time within a
/// step at which the disc reaches the wall.
pub(super) fn thin_wall(trial: &Trial) -> Result<f64> {
    let mut through = 0;
    for phase in 0..PHASES {
        let scene = scenes::thin_wall(trial.level, (f64::from(phase) + 0.5) / f64::from(PHASES));
        let wall = scenes::WALL_DISTANCE * scene.mean_diameter;
        let mut simulation = trial.start(scene)?;
        simulation.take_steps(((scenes::WALL_DISTANCE + 5.0) / trial.level) as u64)?;
        through += u32::from(simulation.world().grains.positions[0].x > wall);
    }
    Ok(f64::from(through) / f64::from(PHASES))
}

// Changes that must not affect the result: another distance of the heap from the origin, another order of the contacts.

const FAR_ROWS: usize = 4;
const FAR_SECS: f64 = 0.1;
const SHUFFLED_ROWS: usize = 6;
/// Largest component of the random initial velocities of grains, in the test that a different numbering of the grains
/// does not change the result, m/s.
const SPEED: f64 = 0.05;

/// Runs a heap at the origin and the same heap far from the origin. Returns the largest difference between the
/// displacements of a grain in the two runs, in mean diameters.
pub(super) fn far(trial: &Trial) -> Result<f64> {
    let [here, there] =
        [0.0, trial.level].map(|distance| scenes::heap_far_away(FAR_ROWS, distance));
    let ways = |scene: Scene| -> Result<Vec<DVec2>> {
        let mut simulation = trial.start(scene.clone())?;
        advance(&mut simulation, FAR_SECS)?;
        let now = simulation.world().grains.positions.iter();
        Ok(now.zip(&scene.grains).map(|(now, grain)| *now - grain.position).collect())
    };
    let diameter = here.mean_diameter;
    let (here, there) = (ways(here)?, ways(there)?);
    let differences = here.iter().zip(&there).map(|(here, there)| here.distance(*there));
    Ok(differences.fold(0.0, f64::max) / diameter)
}

/// Computes one step of a heap with two different numberings of its grains. Returns the largest difference between the
/// two velocities of a grain after the step, divided by the largest velocity.
pub(super) fn shuffle(trial: &Trial) -> Result<f64> {
    let mut random = Pcg64::seed_from_u64(7);
    let mut scene = scenes::heap(SHUFFLED_ROWS);
    scene.solver.tolerance = trial.level;
    // The scene has no friction, because with friction even the velocities of a step are not unique.
    scene.parameters.friction = 0.0;
    for grain in &mut scene.grains {
        let mut component = || SPEED * random.random_range(-1.0..1.0);
        grain.velocity = DVec2::new(component(), component());
    }
    let mut order: Vec<usize> = (0..scene.grains.len()).collect();
    order.shuffle(&mut random);
    let mut shuffled = scene.clone();
    shuffled.grains = order.iter().map(|&index| scene.grains[index].clone()).collect();
    let [mut one, mut other] = [trial.start(scene)?, trial.start(shuffled)?];
    one.step()?;
    other.step()?;
    let [one, other] = [&one, &other].map(|simulation| &simulation.world().grains.velocities);
    let largest = one.iter().map(|velocity| velocity.length()).fold(0.0, f64::max);
    let differences = order.iter().zip(other).map(|(&index, other)| one[index].distance(*other));
    Ok(differences.fold(0.0, f64::max) / largest)
}

// Sudden changes: a grain is removed, the time step changes, or all sliders of the graphical window move at random.

/// Number of steps before the sudden change in a test (a removed grain, or another time step).
const BEFORE: u64 = 50;
/// Number of steps after the sudden change in a test (a removed grain, or another time step).
const AFTER: u64 = 30;
/// Time step in the test of a sudden change of the time step, before the change, s.
const SMALL_STEP_SECS: f64 = 2e-4;
/// Number of rows of discs in the heap of two tests: one with a sudden change of the time step, and one in which the
/// sliders of the graphical window (Bond number, time step, restitution, friction) move at random.
const ROWS: usize = 4;
/// Number of random sequences of settings in this test of the sliders.
const SEQUENCES: u64 = 4;
/// Half the side length of the box around the heap, in mean diameters d, in the test in which the sliders of the
/// graphical window (Bond number, time step, restitution, friction) move at random.
const BOX: f64 = 12.0;
/// Simulated time between two random changes of Bond number, time step, restitution and friction, s, in the test in
/// which the sliders of the graphical window move at random.
const CHANGE_SECS: f64 = 0.05;
/// Most sweeps per step in the test in which the sliders of the graphical window (Bond number, time step, restitution,
/// friction) move at random. The number is so small that the window could show the run in real time.
const LIVE_SWEEPS: u32 = 200;

/// Removes a heavy disc from the top of a column at rest, and returns the largest kinetic energy afterwards, divided by
/// the weight of a disc of the column times the mean diameter.
pub(super) fn lift_off(trial: &Trial) -> Result<f64> {
    let mut simulation = trial.start(scenes::lift_off(trial.level))?;
    simulation.take_steps(BEFORE)?;
    let last = simulation.world().grains.len() - 1;
    simulation.remove_grain(last)?;
    let scale = energy_scale(&simulation);
    let mut energy = 0f64;
    for _ in 0..AFTER {
        energy = energy.max(simulation.step()?.kinetic_energy / scale);
    }
    Ok(energy)
}

/// Increases the time step of a heap at rest suddenly, and returns the motion that arises: the larger of the longest
/// displacement of any grain, in mean diameters d, and the root mean square speed, in √(g d) with gravity g.
pub(super) fn time_step_switch(trial: &Trial) -> Result<f64> {
    let mut scene = scenes::heap(ROWS);
    scene.parameters.time_step_secs = SMALL_STEP_SECS;
    let mut simulation = trial.start(scene.clone())?;
    simulation.take_steps(BEFORE)?;
    let time_step_secs = SMALL_STEP_SECS * trial.level;
    simulation.set_parameters(Parameters { time_step_secs, ..*simulation.parameters() })?;
    simulation.take_steps(AFTER)?;
    Ok(unrest(&simulation, &scene))
}

/// Simulates heaps in closed boxes, as if a user moved the window's sliders (Bond number, time step, restitution,
/// friction) at random and pulled a grain towards a random point. Returns the number of grains that are outside their
/// box at the end.
///
/// One sequence of random settings proves nothing: of 16 sequences, solver `auto` loses grains in 12 within 0.5 s.
pub(super) fn sliders(trial: &Trial) -> Result<f64> {
    (1..=SEQUENCES).map(|seed| grains_outside(trial, seed)).sum()
}

fn grains_outside(trial: &Trial, seed: u64) -> Result<f64> {
    let mut scene = scenes::heap(ROWS);
    scene.solver.max_sweeps = LIVE_SWEEPS;
    let half = BOX * scene.mean_diameter;
    let wall = |normal: DVec2| Boundary::HalfSpace { point: -half * normal, normal };
    scene.boundaries = [DVec2::X, -DVec2::X, DVec2::Y, -DVec2::Y].map(wall).into();
    let radius = scene.grains[0].radius;
    let mut simulation = trial.start(scene)?;
    let mut random = Pcg64::seed_from_u64(seed);
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
