//! What experiments start from: discs on a loose lattice, and discs that have come to rest.

use glam::DVec2;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::trial::Trial;
use crate::error::Result;
use crate::scene::stability::DIAMETER;
use crate::sim::Simulation;
use crate::world::{Boundary, Grain};

/// Diameters are uniform in d·[1 − SPREAD, 1 + SPREAD].
const SPREAD: f64 = 0.2;

/// A half-space through a point in diameters.
pub(super) fn wall(x: f64, y: f64, normal: DVec2) -> Boundary {
    Boundary::HalfSpace { point: DIAMETER * DVec2::new(x, y), normal }
}

/// Discs of random sizes on a jittered lattice, row by row from below, in the middle of a box that is `width` diameters
/// wide and open above.
pub(super) fn loose(count: usize, width: f64, seed: u64) -> Vec<Grain> {
    let spacing = 1.05 * (1.0 + SPREAD);
    let columns = (width / spacing).floor().max(1.0);
    let spacing_x = width / columns;
    let mut random = Pcg64::seed_from_u64(seed);
    let mut jitter = |room: f64| room * random.random_range(-1.0..=1.0f64);
    let place = |index: usize| {
        let (row, column) = ((index as f64 / columns).floor(), index as f64 % columns);
        let radius = 0.5 + jitter(0.5 * SPREAD);
        let x = spacing_x * (column + 0.5) - 0.5 * width + jitter(0.5 * spacing_x - radius);
        let y = spacing * (row + 0.5) + jitter(0.5 * spacing - radius);
        Grain::at_rest(DIAMETER * DVec2::new(x, y), DIAMETER * radius)
    };
    (0..count).map(place).collect()
}

/// Terminal speed of discs that fall through a medium, in √(g d).
const TERMINAL_SPEED: f64 = 0.5;
/// Discs are at rest whose mean kinetic energy is below this, in m g d.
const REST_ENERGY: f64 = 1e-8;

/// Lets discs fall through a medium for as long as the highest takes, and then rest without it: until they do, or as
/// long once more.
///
/// # Errors
/// Where the state is no longer finite.
pub(super) fn settle(trial: &mut Trial) -> Result<()> {
    let world = trial.simulation.world();
    let highest = world.grains.positions.iter().map(|place| place.y).fold(0.0, f64::max);
    let gravity = world.gravity.magnitude();
    let terminal = TERMINAL_SPEED * (gravity * world.mean_diameter).sqrt();
    let falling_secs = 0.6 * highest / terminal + 0.1;
    // Linear, where the exponential would differ in its last digits from one machine to another.
    let drag = 1.0 - trial.simulation.parameters().time_step_secs * gravity / terminal;
    trial.run_until(falling_secs, |simulation| simulation.scale_velocities(drag))?;
    let piece_secs = 0.1 * falling_secs;
    for number in 1..=10 {
        trial.run_until(falling_secs + f64::from(number) * piece_secs, |_| ())?;
        if energy(&trial.simulation) < REST_ENERGY {
            break;
        }
    }
    Ok(())
}

/// Mean kinetic energy of a disc, in m g d.
pub(super) fn energy(simulation: &Simulation) -> f64 {
    let world = simulation.world();
    let mass: f64 = world.grains.masses.iter().sum();
    let unit = mass * world.gravity.magnitude() * world.mean_diameter;
    simulation.observables().kinetic_energy / unit
}
