//! Generation of new piles: discs are put into a box over a rough base and left to come to rest, by rain or by drop
//! and roll.

mod drop_and_roll;
mod rain;
mod rolling;

pub use drop_and_roll::drop_and_roll;
pub use rolling::{Deposit, Rest, Support, dropped};

use glam::DVec2;
use rand_pcg::Pcg64;

use crate::error::{Error, Result};
use crate::scene::Scene;
use crate::scene::new_pile::{Deposition, NewPile};
use crate::scene::paper::{DIAMETER, GRAVITY, pile_of};
use crate::sim::{Observables, Simulation};
use crate::solver::SolverSettings;
use crate::world::{Boundary, Grain, Parameters};

/// Generates the initial state of a pile: places the grains and lets them come to rest. `progress` is called from
/// time to time. If it returns false, the generation stops with an error.
///
/// # Errors
/// If a value is outside its range, the grains do not come to rest, or `progress` returns false.
pub fn settle(pile: &NewPile, progress: impl FnMut(Settling) -> bool) -> Result<Vec<Grain>> {
    Ok(deposit(pile, progress)?.grains)
}

/// Like [`settle`], but also returns the remaining motion and overlap of the grains.
///
/// # Errors
/// The errors of [`settle`].
pub fn deposit(pile: &NewPile, progress: impl FnMut(Settling) -> bool) -> Result<Settled> {
    pile.validate()?;
    match pile.deposition {
        Deposition::Rain => rain::settled(pile, progress),
        Deposition::DropAndRoll => drop_and_roll::settled(pile, progress),
    }
}

/// Returns the grains of a new pile before they settle. This takes little time, because no steps are computed.
pub fn start_of(pile: &NewPile) -> Vec<Grain> {
    match pile.deposition {
        Deposition::Rain => rain::lattice(pile),
        Deposition::DropAndRoll => drop_and_roll::start_of(pile),
    }
}

fn random_radius(pile: &NewPile, random: &mut Pcg64) -> f64 {
    0.5 * DIAMETER * pile.sizes.draw(random)
}

/// Time for which a pile must have been slow until it counts as at rest, s.
const REST_SECS: f64 = 0.02;

/// Progress of a pile that comes to rest.
#[derive(Clone, Copy, Debug)]
pub struct Settling<'a> {
    /// The pile in its present state.
    pub simulation: &'a Simulation,
    /// True if grains may still be falling through the medium that slows the rain.
    pub rains: bool,
    /// Simulated time, s.
    pub time_secs: f64,
    /// Simulated time after which the generation fails, s.
    pub limit_secs: f64,
    /// Speed relative to the speed below which a pile is at rest. At most 1 for a pile at rest.
    pub speed_over_rest: f64,
}

/// A pile at rest. The velocities of its grains were set to zero, and the numbers describe the pile just before that.
#[derive(Clone, Debug)]
pub struct Settled {
    /// The grains.
    pub grains: Vec<Grain>,
    /// Mean kinetic energy of a grain, in m g d (mass, gravity, mean diameter).
    pub kinetic_energy: f64,
    /// Mean overlap of touching pairs of grains, in mean diameters.
    pub mean_overlap: f64,
    /// Largest overlap of any contact, in mean diameters.
    pub max_overlap: f64,
}

impl Settled {
    fn of(mut simulation: Simulation) -> Self {
        let kinetic_energy = kinetic_energy(&simulation);
        let &Observables { mean_overlap, max_overlap, .. } = simulation.observables();
        simulation.bring_to_rest();
        let grains = &simulation.world().grains;
        let grains = (0..grains.len())
            .map(|index| Grain { angular_velocity: 0.0, ..grains.grain(index) })
            .collect();
        Self { grains, kinetic_energy, mean_overlap, max_overlap }
    }
}

fn interrupted() -> Error {
    Error::value("generation", "interrupted", "left to end")
}

fn not_at_rest(speed_over_rest: f64, limit_secs: f64) -> Error {
    let allowed = format!("below 1 within {limit_secs:.1} s of simulated time");
    Error::value("speed over rest", speed_over_rest, allowed)
}

/// Returns the two side walls of the box in which the grains of a pile come to rest.
pub fn walls(box_width_in_diameters: f64) -> Vec<Boundary> {
    let wall = |side: f64| Boundary::HalfSpace {
        point: DVec2::new(side * 0.5 * box_width_in_diameters * DIAMETER, 0.0),
        normal: DVec2::new(-side, 0.0),
    };
    vec![wall(-1.0), wall(1.0)]
}

/// Returns the scene of a pile without cohesion, and with the side walls of the box.
fn in_a_box(
    grains: Vec<Grain>,
    box_width_in_diameters: f64,
    time_step_secs: f64,
    solver: SolverSettings,
) -> Result<Scene> {
    let pile = pile_of(grains, box_width_in_diameters)?;
    Ok(Scene {
        boundaries: walls(box_width_in_diameters),
        parameters: Parameters {
            bond: 0.0,
            time_step_secs,
            touch_tolerance: 0.0,
            ..pile.parameters
        },
        solver,
        ..pile
    })
}

/// Returns the speed of the fastest grain, m/s.
fn fastest(simulation: &Simulation) -> f64 {
    speeds(simulation).fold(0.0, f64::max)
}

/// Returns the speed of each grain, m/s: the larger of the speed of its centre and the speed of its rim by rotation.
fn speeds(simulation: &Simulation) -> impl Iterator<Item = f64> {
    let grains = &simulation.world().grains;
    let turning = grains.angular_velocities.iter().zip(&grains.radii).map(|(w, r)| (w * r).abs());
    grains.velocities.iter().map(|velocity| velocity.length()).zip(turning).map(|(v, w)| v.max(w))
}

/// Returns the mean kinetic energy of a grain, in m g d (mass, gravity, mean diameter).
fn kinetic_energy(simulation: &Simulation) -> f64 {
    let weight: f64 = simulation.world().grains.masses.iter().map(|mass| mass * GRAVITY).sum();
    simulation.observables().kinetic_energy / (weight * DIAMETER)
}
