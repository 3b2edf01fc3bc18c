//! What must not matter: where the origin is, and in which order the contacts come.

use glam::DVec2;
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::error::Result;
use crate::scene::Scene;
use crate::scene::stability::{heap, heap_far_away};
use crate::stability::trial::{Trial, advance};

/// Rows of the heap far from the origin.
const FAR_ROWS: usize = 4;
/// Simulated time of its run, s.
const FAR_SECS: f64 = 0.1;
/// Rows of the heap that is shuffled.
const SHUFFLED_ROWS: usize = 6;
/// Largest component of its grains' velocities, m/s.
const SPEED: f64 = 0.05;

/// Largest difference of the ways of a grain between a run far from the origin and the same at the
/// origin, in d.
pub(crate) fn far(trial: &Trial) -> Result<f64> {
    let [here, there] = [0.0, trial.level].map(|distance| heap_far_away(FAR_ROWS, distance));
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

/// Largest difference of velocities after a step between two numberings of the same grains, over the
/// largest velocity.
pub(crate) fn shuffle(trial: &Trial) -> Result<f64> {
    let mut random = Pcg64::seed_from_u64(7);
    let mut scene = heap(SHUFFLED_ROWS);
    scene.solver.tolerance = trial.level;
    // With friction not even the velocities of a step are unique.
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
