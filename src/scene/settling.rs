//! Initial states: discs rained into a box over a rough base and left to come to rest.
//!
//! The discs start on a loose lattice above the base, jittered and at rest, and fall through a
//! medium that slows them to a terminal speed of √(g·d)/2, so that they land without overlapping by
//! more than terminal speed × Δt, whatever the height of the box. Once the pile has formed, the
//! medium is taken away and the pile settles under the laws of the paper's runs without cohesion.

use glam::DVec2;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::pile::{DIAMETER, GRAVITY};
use super::rain::SPACING;
use super::{Rain, Scene, pile_of};
use crate::error::{Error, Result};
use crate::sim::Simulation;
use crate::solver::SolverSettings;
use crate::world::{Boundary, Grain, Parameters};

/// How far a settling has come.
#[derive(Clone, Copy, Debug)]
pub struct Settling {
    /// Simulated time, s.
    pub time_secs: f64,
    /// Simulated time after which it is given up, s.
    pub limit_secs: f64,
    /// Fastest grain, in units of the speed that counts as rest.
    pub speed_over_rest: f64,
}

/// Diameters are uniform in d·[1 − SPREAD, 1 + SPREAD].
const SPREAD: f64 = 0.2;
/// Time step of the settling, s. The overlaps of the initial state scale with it.
const TIME_STEP_SECS: f64 = 1e-4;
/// A pile whose grains have all been slower than this, in units of √(g·d), for [`REST_SECS`] is at
/// rest.
const REST_SPEED: f64 = 2e-4;
/// s.
const REST_SECS: f64 = 0.02;
/// Steps between two looks at the speeds.
const STEPS_PER_LOOK: u32 = 100;

/// Makes an initial state. `progress` is called now and then; where it returns false, the settling
/// is given up with an error.
///
/// # Errors
/// Where a value is outside its range, the grains do not come to rest, or `progress` says so.
pub fn settle(rain: &Rain, mut progress: impl FnMut(Settling) -> bool) -> Result<Vec<Grain>> {
    rain.validate()?;
    let columns = rain.columns();
    let scene = box_of(lattice(rain), rain.box_width_in_diameters)?;
    let mut simulation = scene.simulation()?;

    let rows = (rain.grains as f64 / columns as f64).ceil();
    let speed_unit = (GRAVITY * DIAMETER).sqrt();
    let terminal_speed = 0.5 * speed_unit;
    // The upper rows fall the farthest; the pile they land on is lower than the lattice.
    let raining_secs = rows * SPACING * DIAMETER / terminal_speed + 0.1;
    let limit_secs = 4.0 * raining_secs + 2.0;
    // Linear, where the exponential would differ in its last digits from one machine to another.
    let drag_per_step = 1.0 - TIME_STEP_SECS * GRAVITY / terminal_speed;
    let mut slow_since_secs = f64::INFINITY;
    loop {
        for _ in 0..STEPS_PER_LOOK {
            simulation.step()?;
            if simulation.time_secs() < raining_secs {
                simulation.scale_velocities(drag_per_step);
            }
        }
        let time_secs = simulation.time_secs();
        let speed_over_rest = fastest(&simulation) / (REST_SPEED * speed_unit);
        if !progress(Settling { time_secs, limit_secs, speed_over_rest }) {
            return Err(Error::value("generation", "interrupted", "left to end"));
        }
        if speed_over_rest > 1.0 || time_secs < raining_secs {
            slow_since_secs = f64::INFINITY;
        } else {
            slow_since_secs = slow_since_secs.min(time_secs);
            if time_secs - slow_since_secs >= REST_SECS {
                break;
            }
        }
        if time_secs > limit_secs {
            let allowed = format!("below 1 within {limit_secs:.1} s of simulated time");
            return Err(Error::value("speed over rest", speed_over_rest, allowed));
        }
    }
    simulation.bring_to_rest();
    let grains = &simulation.world().grains;
    Ok((0..grains.len())
        .map(|index| Grain { angular_velocity: 0.0, ..grains.grain(index) })
        .collect())
}

/// Discs on a jittered lattice, row by row from below.
pub(super) fn lattice(rain: &Rain) -> Vec<Grain> {
    let columns = rain.columns();
    let mut random = Pcg64::seed_from_u64(rain.seed);
    let spacing = SPACING * DIAMETER;
    (0..rain.grains)
        .map(|index| {
            let radius = 0.5 * DIAMETER * random.random_range(1.0 - SPREAD..=1.0 + SPREAD);
            let room = 0.5 * spacing - radius;
            let jitter =
                DVec2::new(random.random_range(-1.0..=1.0), random.random_range(-1.0..=1.0));
            let column = (index % columns) as f64 - 0.5 * (columns - 1) as f64;
            let row = (index / columns) as f64 + 1.5;
            Grain::at_rest(spacing * DVec2::new(column, row) + room * jitter, radius)
        })
        .collect()
}

/// The walls of a box for the pile's scene.
pub(crate) fn walls(box_width_in_diameters: f64) -> Vec<Boundary> {
    let wall = |side: f64| Boundary::HalfSpace {
        point: DVec2::new(side * 0.5 * box_width_in_diameters * DIAMETER, 0.0),
        normal: DVec2::new(-side, 0.0),
    };
    vec![wall(-1.0), wall(1.0)]
}

/// The pile's scene without cohesion and with walls.
fn box_of(grains: Vec<Grain>, box_width_in_diameters: f64) -> Result<Scene> {
    let pile = pile_of(grains, box_width_in_diameters)?;
    Ok(Scene {
        boundaries: walls(box_width_in_diameters),
        parameters: Parameters { bond: 0.0, time_step_secs: TIME_STEP_SECS, ..pile.parameters },
        solver: SolverSettings { tolerance: 1e-4, max_sweeps: 1000, ..pile.solver },
        ..pile
    })
}

fn fastest(simulation: &Simulation) -> f64 {
    let grains = &simulation.world().grains;
    let turning = grains.angular_velocities.iter().zip(&grains.radii).map(|(w, r)| (w * r).abs());
    grains.velocities.iter().map(|velocity| velocity.length()).chain(turning).fold(0.0, f64::max)
}
