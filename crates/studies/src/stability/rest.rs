//! Measures the errors of stability tests with scenes that must stay at rest, or must yield at the right load: columns,
//! piles, cohesive rows, and discs in a space that is too small. Each function runs a trial (one solver variant at one
//! difficulty) and returns an error that is 0 for the right answer.

use super::{Trial, advance, force_on_ground, jitter, longest_way, threshold, unrest};
use crate::error::Result;
use crate::scene::stability as scenes;
use crate::scene::{Scene, cradle};
use crate::sim::Simulation;
use crate::world::Parameters;

// Columns: the load on the floor, and the sinking of the top. A step that is not solved accurately leaves the discs
// with a speed, so that a column sinks as if its discs were soft: the apparent elasticity of a solver that has not
// converged.

const COLUMN_SECS: f64 = 0.1;
/// Most sweeps per step in tests that do not vary this number. It is small, as in the graphical window, which must show
/// a run in real time.
const FEW_SWEEPS: u32 = 100;
const SAGGING_DISCS: usize = 20;

/// Returns the largest error of the force with which a column presses on the floor, in the last quarter of the run,
/// divided by the weight of the column.
pub(super) fn column(trial: &Trial) -> Result<f64> {
    let mut simulation = trial.start(with_sweeps(FEW_SWEEPS, scenes::column(trial.count())))?;
    let world = simulation.world();
    let weight = world.grains.masses.iter().sum::<f64>() * world.gravity.magnitude();
    advance(&mut simulation, 0.75 * COLUMN_SECS)?;
    let mut worst = 0f64;
    for _ in 0..simulation.parameters().steps_in(0.25 * COLUMN_SECS) {
        simulation.step()?;
        worst = worst.max((force_on_ground(&simulation) / weight - 1.0).abs());
    }
    Ok(worst)
}

/// Returns the scene of a column of `count` discs, with solver settings for `sweeps` sweeps (or substeps) per step
/// without a warm start.
pub(super) fn sagging(count: usize, sweeps: u32) -> Scene {
    let mut scene = scenes::column(count);
    scene.solver.max_sweeps = sweeps;
    scene.parameters.substeps = sweeps;
    scene.solver.tolerance = 1e-12;
    scene.solver.warm_start = false;
    scene
}

/// Runs a column with few sweeps per step, and returns the distance by which its top sinks during the run, in mean
/// diameters d.
pub(super) fn sag(trial: &Trial) -> Result<f64> {
    sunk_in(trial, &sagging(SAGGING_DISCS, trial.count() as u32))
}

/// Returns the distance by which a heavy disc that lies on a light disc sinks during the run, in mean diameters d.
pub(super) fn mass_ratio(trial: &Trial) -> Result<f64> {
    sunk_in(trial, &with_sweeps(FEW_SWEEPS, scenes::mass_ratio(trial.level)))
}

/// Returns the distance by which a large disc that lies on two small discs sinks during the run, in mean diameters d.
pub(super) fn size_ratio(trial: &Trial) -> Result<f64> {
    sunk_in(trial, &with_sweeps(FEW_SWEEPS, scenes::logs(trial.level)))
}

fn with_sweeps(sweeps: u32, mut scene: Scene) -> Scene {
    scene.solver.max_sweeps = sweeps;
    scene
}

fn sunk_in(trial: &Trial, scene: &Scene) -> Result<f64> {
    let mut simulation = trial.start(scene.clone())?;
    advance(&mut simulation, COLUMN_SECS)?;
    Ok(sunk(&simulation, scene))
}

/// Returns the displacement of the grain that is last in the list of grains, such as the top disc of a column, since
/// the initial state in `scene`, in mean diameters d.
pub(super) fn sunk(simulation: &Simulation, scene: &Scene) -> f64 {
    let last = scene.grains.len() - 1;
    let [before, now] = [scene.grains[last].position, simulation.world().grains.positions[last]];
    before.distance(now) / scene.mean_diameter
}

// Piles that must stay at rest, and piles that must yield.

const ROWS: usize = 6;
const STANDING_SECS: f64 = 0.2;
const SMALL_ROWS: usize = 4;
/// Friction coefficient below which a pile of three equal logs slides apart: tan 15° = 2 − √3.
const FRICTION_OF_LOGS: f64 = 0.267_949_192_431_122_7;
/// Displacement of the grain that has moved farthest, in mean diameters d. With at least this displacement at the end
/// of a test, a pile counts as sliding.
const SLID: f64 = 0.02;
/// Duration of the runs that test whether a pile slides, s.
const SLIDING_SECS: f64 = 0.2;
/// Factor that defines the range in which the friction coefficient at which a pile slides is searched: from the right
/// value divided by the factor to the right value times the factor.
const FRICTION_RANGE: f64 = 4.0;
/// Factor that defines the range in which the slope angle at which a pile slides is searched: from the right value
/// divided by the factor to the right value times the factor.
const ANGLE_RANGE: f64 = 2.0;
/// Number of bisections in the search for the friction coefficient or the slope angle at which a pile slides. They
/// determine friction to 1 % and angles to 0.5 %.
const PILE_HALVINGS: u32 = 8;

/// Runs a scene for the simulated time `secs` (s), and returns the longest displacement of any grain, in mean diameters
/// d.
fn way_in(trial: &Trial, secs: f64, scene: Scene) -> Result<f64> {
    let mut simulation = trial.start(scene.clone())?;
    advance(&mut simulation, secs)?;
    Ok(longest_way(&simulation, &scene))
}

fn with_time_step(trial: &Trial, mut scene: Scene) -> Scene {
    scene.parameters.time_step_secs = trial.level;
    scene
}

/// Runs a heap that must stay at rest, and returns the longest displacement of any grain, in mean diameters d.
pub(super) fn repose(trial: &Trial) -> Result<f64> {
    way_in(trial, STANDING_SECS, with_time_step(trial, scenes::heap(ROWS)))
}

/// Returns the relative error of the friction coefficient below which a pile of three logs slides apart.
pub(super) fn friction_limit(trial: &Trial) -> Result<f64> {
    least_friction(trial, &scenes::logs(1.0), FRICTION_OF_LOGS)
}

/// Returns the relative error of the friction coefficient below which the keystone of an arch slips through.
pub(super) fn arch(trial: &Trial) -> Result<f64> {
    least_friction(trial, &scenes::arch(), scenes::FRICTION_OF_ARCH)
}

/// Measures the smallest rolling friction with which a leaning column stays at rest, and returns its relative error.
///
/// If the moment of the lowest contact is smaller than the necessary moment by the fraction ε, the column of n discs
/// turns about this contact like a rod, and its top moves by about (3/8) ε g t²/n in the time t, with gravity g. So the
/// test of n discs takes a time that grows with √n.
pub(super) fn leaning_column(trial: &Trial) -> Result<f64> {
    let right = scenes::ROLLING_FRICTION_OF_COLUMN;
    let scene = with_sweeps(FEW_SWEEPS, scenes::leaning_column(trial.count()));
    let secs = SLIDING_SECS * (trial.level / 5.0).sqrt();
    least(trial, secs, &scene, right, |parameters| &mut parameters.rolling_friction)
}

fn least_friction(trial: &Trial, scene: &Scene, right: f64) -> Result<f64> {
    let scene = with_time_step(trial, scene.clone());
    least(trial, SLIDING_SECS, &scene, right, |parameters| &mut parameters.friction)
}

/// Returns the relative error of the smallest value of a parameter at which a scene stays at rest for `secs`. `right` is
/// the exact smallest value.
fn least(
    trial: &Trial,
    secs: f64,
    scene: &Scene,
    right: f64,
    parameter: fn(&mut Parameters) -> &mut f64,
) -> Result<f64> {
    let range = [right / FRICTION_RANGE, right * FRICTION_RANGE];
    let least = threshold(range, PILE_HALVINGS, |value| {
        let mut scene = scene.clone();
        *parameter(&mut scene.parameters) = value;
        Ok(way_in(trial, secs, scene)? < SLID)
    })?;
    Ok((least / right - 1.0).abs())
}

/// Returns the relative error of the steepest slope on which a heap stays at rest.
pub(super) fn repose_angle(trial: &Trial) -> Result<f64> {
    let right = scenes::STEEPEST_DEGREES;
    let steepest =
        threshold([right / ANGLE_RANGE, right * ANGLE_RANGE], PILE_HALVINGS, |degrees| {
            let scene = with_sweeps(FEW_SWEEPS, scenes::heap_on_slope(trial.count(), degrees));
            Ok(way_in(trial, SLIDING_SECS, scene)? >= SLID)
        })?;
    Ok((steepest / right - 1.0).abs())
}

/// Runs a heap at rest for very many steps, and returns the larger of two numbers at the end: the longest displacement
/// of any grain, in mean diameters d, and the root mean square speed, in √(g d) with gravity g.
pub(super) fn rest(trial: &Trial) -> Result<f64> {
    let scene = scenes::heap(SMALL_ROWS);
    let mut simulation = trial.start(scene.clone())?;
    simulation.take_steps(trial.count() as u64)?;
    Ok(unrest(&simulation, &scene))
}

// Very many contacts at rest, with few sweeps per step.

/// Most sweeps per step in the tests with very many contacts (iterations for a method without sweeps). The graphical
/// window has time for about this many sweeps.
const WINDOW_SWEEPS: u32 = 40;
/// Number of steps in the tests with very many contacts. The first step begins with all contact impulses 0. In free
/// fall, a grain would move by 0.2 diameters in these steps.
const STEPS: u64 = 20;
/// Size of the lattice of discs in the test with very many contacts: number of discs in every other row, and number of
/// rows. The lattice has 3,900 contacts.
const LATTICE: [usize; 2] = [37, 36];

/// Runs a lattice of discs that must stay at rest, and returns the largest of three numbers: the longest displacement,
/// in mean diameters d; the root mean square speed, in √(g d) with gravity g; and the residual of the last step.
pub(super) fn hyperstatic(trial: &Trial) -> Result<f64> {
    let [columns, rows] = LATTICE;
    let scene = scenes::lattice(columns, rows, trial.level);
    let mut simulation = trial.start_within(WINDOW_SWEEPS, scene.clone())?;
    simulation.take_steps(STEPS)?;
    Ok(unrest(&simulation, &scene).max(simulation.observables().residual))
}

/// Runs a heap that must stay at rest. Its number of grains is the driving parameter of `trial` (the parameter that
/// makes the test more difficult). Returns the larger of two numbers: the longest displacement, in mean diameters d,
/// and the root mean square speed, in √(g d) with gravity g.
pub(super) fn size(trial: &Trial) -> Result<f64> {
    let scene = scenes::heap_of(trial.count());
    let mut simulation = trial.start_within(WINDOW_SWEEPS, scene.clone())?;
    simulation.take_steps(STEPS)?;
    Ok(unrest(&simulation, &scene))
}

// Cohesion: bonds must hold, and must break at the right load. The static pull-off force must not depend on the time
// step.

const CHAIN: usize = 8;
/// Duration of the test whether a hanging chain breaks, s. If the load is 1 % above the strength, the chain opens in a
/// third of this duration.
const CHAIN_SECS: f64 = 0.04;
/// Time in which the chain hangs at rest before it is tested, s. During this time the chain has [`SURE`] times its
/// breaking Bond number, so that it does not break.
const HANG_SECS: f64 = 0.04;
/// Bond number of the chain while it hangs at rest before it is tested, divided by the Bond number at which it breaks.
/// With a much larger value, bonds with springs would recoil when the Bond number is reduced for the test.
const SURE: f64 = 1.5;
/// Number of bisections with which the Bond number is searched at which a chain breaks. The search begins between a
/// quarter of the right value and four times the right value. Nine bisections reduce the ratio of the two ends from 16
/// to 16^(1/2⁹) = 1.005.
const CHAIN_HALVINGS: u32 = 9;
/// Duration of the tests of a cohesive bridge and a cohesive cantilever, s. If the bridge or the cantilever is torn
/// off, it falls by 30 diameters in this duration.
const WATCH_SECS: f64 = 0.25;
/// Length of the cohesive cantilever in its stability test: number of grains in each of its two rows.
pub(super) const CANTILEVER: i32 = 4;
/// Length of the cohesive bridge in its stability test: number of grains in the lower of its two rows.
const BRIDGE: i32 = 10;
/// Time step in the test of the cradle of Abramian & Staron (2020), in which a disc hits two bonded discs, s. At this
/// time step the bond opens in their article, because their solver has not converged.
const SHOCK_STEP_SECS: f64 = 5e-4;

/// Returns the relative error of the Bond number below which a hanging chain breaks.
pub(super) fn chain(trial: &Trial) -> Result<f64> {
    let right = scenes::breaking_bond(CHAIN);
    let breaking = threshold([0.25 * right, 4.0 * right], CHAIN_HALVINGS, |bond| {
        let scene = with_time_step(trial, scenes::hanging_chain(CHAIN, SURE * right));
        let mut simulation = trial.start(scene)?;
        advance(&mut simulation, HANG_SECS)?;
        simulation.set_parameters(Parameters { bond, ..*simulation.parameters() })?;
        advance(&mut simulation, CHAIN_SECS)?;
        Ok(simulation.observables().contacts as usize == CHAIN)
    })?;
    Ok((breaking / right - 1.0).abs())
}

/// Runs a cohesive cantilever that must stay at rest, and returns the longest displacement of any grain, in mean
/// diameters d.
pub(super) fn cantilever(trial: &Trial) -> Result<f64> {
    way_in(trial, WATCH_SECS, with_time_step(trial, scenes::cantilever(CANTILEVER)))
}

/// Runs a cohesive bridge that must stay at rest, and returns the longest displacement of any grain, in mean diameters
/// d.
pub(super) fn bridge(trial: &Trial) -> Result<f64> {
    way_in(trial, WATCH_SECS, with_time_step(trial, scenes::bridge(BRIDGE)))
}

/// Runs the cradle of Abramian & Staron (2020), in which disc k hits two bonded discs i and j. Returns the gap between
/// i and j at the end, in diameters. If the steps are solved accurately, the bond holds, and the gap is 0.
pub(super) fn shock(trial: &Trial) -> Result<f64> {
    let mut scene = cradle();
    scene.parameters.time_step_secs = SHOCK_STEP_SECS;
    scene.solver.tolerance = trial.level;
    let mut simulation = trial.start(scene.clone())?;
    advance(&mut simulation, scene.duration_secs)?;
    let places = &simulation.world().grains.positions;
    Ok(((places[1].x - places[0].x) / scene.mean_diameter - 1.0).abs())
}

// Discs in a space that is too small.

const RECOVERY_SECS: f64 = 0.3;
const SETTLING_SECS: f64 = 0.2;
const WATCHED_STEPS: u64 = 100;

/// Runs a scene with overlapping discs for 0.3 s, and returns the larger of two numbers: the fraction of the overlap
/// that remains, and the largest kinetic energy during the run, divided by m g d (weight of a disc times mean
/// diameter).
pub(super) fn overlap(trial: &Trial) -> Result<f64> {
    let mut simulation = trial.start(scenes::overlapped(trial.level))?;
    let scale = super::energy_scale(&simulation);
    let mut energy = 0f64;
    while simulation.time_secs() < RECOVERY_SECS {
        energy = energy.max(simulation.step()?.kinetic_energy / scale);
    }
    let left = simulation.observables().max_overlap / trial.level;
    Ok(left.max(energy))
}

/// Runs discs in a box that is too small for them, and returns the larger of two numbers: the fraction of the steps
/// that were not solved to their tolerance, and the root mean square speed of the discs, averaged over the last hundred
/// steps, in √(g d) with gravity g and mean diameter d.
pub(super) fn squeeze(trial: &Trial) -> Result<f64> {
    let mut simulation = trial.start(scenes::squeeze(trial.level))?;
    let (mut unsolved, mut speeds) = (0u64, 0.0);
    let settling = simulation.parameters().steps_in(SETTLING_SECS);
    for step in 0..settling + WATCHED_STEPS {
        unsolved += u64::from(!simulation.step()?.converged);
        if step >= settling {
            speeds += jitter(&simulation);
        }
    }
    let share = unsolved as f64 / (settling + WATCHED_STEPS) as f64;
    Ok(share.max(speeds / WATCHED_STEPS as f64))
}

/// Moves walls inwards, which press grains together, and waits for the grains to come to rest. Returns the larger of
/// two numbers: the largest distance of a grain from its only possible position, in mean diameters d, and the root mean
/// square speed, in √(g d) with gravity g.
pub(super) fn moving_walls(trial: &Trial) -> Result<f64> {
    let mut simulation = trial.start(with_time_step(trial, scenes::press()))?;
    advance(&mut simulation, scenes::pressing_secs() + SETTLING_SECS)?;
    let world = simulation.world();
    let places = scenes::pressed_places();
    let errors =
        world.grains.positions.iter().zip(&places).map(|(now, right)| now.distance(*right));
    let furthest = errors.fold(0.0, f64::max) / world.mean_diameter;
    Ok(furthest.max(jitter(&simulation)))
}
