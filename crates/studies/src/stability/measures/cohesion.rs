//! Cohesion: what it has to hold, and when it has to let go. The static pull-off force knows no time
//! step.

use crate::error::Result;
use crate::scene::stability::{self, breaking_bond, hanging_chain};
use crate::scene::{Scene, cradle};
use crate::stability::trial::{Trial, advance, longest_way, threshold};
use crate::world::Parameters;

/// Discs of the hanging chain.
const CHAIN: usize = 8;
/// The watch over a chain, s: overloaded by a hundredth, it opens in a third of that.
const CHAIN_SECS: f64 = 0.04;
/// Time to hang still first, s, at a Bond number that holds, in units of the breaking one. Much more
/// would make springs recoil.
const HANG_SECS: f64 = 0.04;
const SURE: f64 = 1.5;
/// The breaking Bond number is searched down to 4^(1/2^8), 0.5 %.
const HALVINGS: u32 = 9;
/// Time that bridge and cantilever are watched, s: torn, they fall 30 d in it.
const WATCH_SECS: f64 = 0.25;
/// Grains of a row.
const CANTILEVER: i32 = 4;
const BRIDGE: i32 = 10;
/// Time step of the shock, s: the paper's bond opens at it, for want of convergence.
const SHOCK_STEP_SECS: f64 = 5e-4;

/// Relative error of the Bond number at which a chain breaks.
pub(crate) fn chain(trial: &Trial) -> Result<f64> {
    let right = breaking_bond(CHAIN);
    let found = threshold([0.25 * right, 4.0 * right], HALVINGS, |bond| {
        let mut scene = hanging_chain(CHAIN, SURE * right);
        scene.parameters.time_step_secs = trial.level;
        let mut simulation = trial.start(scene)?;
        advance(&mut simulation, HANG_SECS)?;
        simulation.set_parameters(Parameters { bond, ..*simulation.parameters() })?;
        advance(&mut simulation, CHAIN_SECS)?;
        Ok(simulation.observables().contacts as usize == CHAIN)
    })?;
    Ok((found / right - 1.0).abs())
}

/// How far the grain of a cantilever that moves most goes, in d.
pub(crate) fn cantilever(trial: &Trial) -> Result<f64> {
    watched(trial, stability::cantilever(CANTILEVER))
}

/// How far the grain of a bridge that moves most goes, in d.
pub(crate) fn bridge(trial: &Trial) -> Result<f64> {
    watched(trial, stability::bridge(BRIDGE))
}

fn watched(trial: &Trial, mut scene: Scene) -> Result<f64> {
    scene.parameters.time_step_secs = trial.level;
    let mut simulation = trial.start(scene.clone())?;
    advance(&mut simulation, WATCH_SECS)?;
    Ok(longest_way(&simulation, &scene))
}

/// Gap between i and j of the paper's cradle after the shock, in d: solved well, it stays closed.
pub(crate) fn shock(trial: &Trial) -> Result<f64> {
    let mut scene = cradle();
    scene.parameters.time_step_secs = SHOCK_STEP_SECS;
    scene.solver.tolerance = trial.level;
    let mut simulation = trial.start(scene.clone())?;
    advance(&mut simulation, scene.duration_secs)?;
    let places = &simulation.world().grains.positions;
    Ok(((places[1].x - places[0].x) / scene.mean_diameter - 1.0).abs())
}
