//! Runs the scenes of experiments, makes their initial states, and provides common measurements.

use std::f64::consts::PI;

use glam::DVec2;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::experiment::{RunReadings, named};
use crate::error::Result;
use crate::granular::measure;
use crate::scene::Scene;
use crate::scene::stability::DIAMETER;
use crate::sim::{Moment, Simulation, Tally};
use crate::world::{Boundary, Grain};

/// Relative spread of the diameters, which are distributed uniformly in d·[1 − SPREAD, 1 + SPREAD] with the mean
/// diameter d.
const SPREAD: f64 = 0.2;
/// Terminal speed of discs that fall through a viscous medium to form an initial state, in √(g d), with gravity g and
/// mean diameter d.
const TERMINAL_SPEED: f64 = 0.5;
/// Mean kinetic energy of a disc below which the discs count as at rest, in m g d (weight of a disc times mean
/// diameter).
const REST_ENERGY: f64 = 1e-8;

/// A run in progress, with statistics of its steps so far.
pub(super) struct WatchedRun {
    pub simulation: Simulation,
    tally: Tally,
}

impl WatchedRun {
    pub(super) fn start(scene: &Scene) -> Result<Self> {
        Ok(Self { simulation: scene.simulation()?, tally: Tally::default() })
    }

    /// Computes steps until the simulated time `secs` (s), and calls `after` after each step.
    pub(super) fn run_until(
        &mut self,
        secs: f64,
        mut after: impl FnMut(&mut Simulation),
    ) -> Result<()> {
        while self.simulation.observables().step < self.simulation.step_at(secs) {
            self.simulation.step()?;
            self.tally.add(self.simulation.observables());
            after(&mut self.simulation);
        }
        Ok(())
    }

    /// Returns the result of the run: the given measured numbers with their names, and statistics of the run's steps.
    pub(super) fn with<const COUNT: usize>(&self, readings: [(&str, f64); COUNT]) -> RunReadings {
        RunReadings {
            readings: named(readings),
            simulated_secs: self.simulation.time_secs(),
            steps: self.tally.steps,
            unsolved_steps: self.tally.unconverged_steps,
            lost_grains: self.simulation.observables().lost_grains,
            blew_up: false,
        }
    }
}

/// Lets the discs of a scene fall through a viscous medium for the time that the highest disc needs to reach the
/// bottom. Then the medium is removed, and the run continues until the discs are at rest, but at most for the same time
/// again.
pub(super) fn settled(scene: &Scene) -> Result<WatchedRun> {
    let mut run = WatchedRun::start(scene)?;
    let world = run.simulation.world();
    let highest = world.grains.positions.iter().map(|place| place.y).fold(0.0, f64::max);
    let gravity = world.gravity.magnitude();
    let terminal = TERMINAL_SPEED * (gravity * world.mean_diameter).sqrt();
    let falling_secs = 0.6 * highest / terminal + 0.1;
    // The drag is linear in the time step, because an exponential could differ in its last digits between machines.
    let drag = 1.0 - run.simulation.parameters().time_step_secs * gravity / terminal;
    run.run_until(falling_secs, |simulation| simulation.scale_velocities(drag))?;
    let piece_secs = 0.1 * falling_secs;
    for number in 1..=10 {
        run.run_until(falling_secs + f64::from(number) * piece_secs, |_| ())?;
        if mean_energy(&run.simulation) < REST_ENERGY {
            break;
        }
    }
    Ok(run)
}

/// Returns the grains of a run at their present positions, with all velocities 0.
pub(super) fn at_rest(run: &WatchedRun) -> Vec<Grain> {
    let grains = &run.simulation.world().grains;
    let rest = |index| {
        let grain = grains.grain(index);
        Grain::at_rest(grain.position, grain.radius)
    };
    (0..grains.len()).map(rest).collect()
}

/// Returns a wall: a half-space whose boundary goes through the point (x, y), in diameters. `normal` points out of the
/// wall.
pub(super) fn wall(x: f64, y: f64, normal: DVec2) -> Boundary {
    Boundary::HalfSpace { point: DIAMETER * DVec2::new(x, y), normal }
}

/// Returns the floor and the two side walls of a box that is open above and `width` diameters wide.
pub(super) fn open_box(width: f64) -> Vec<Boundary> {
    let half = 0.5 * width;
    vec![wall(0.0, 0.0, DVec2::Y), wall(-half, 0.0, DVec2::X), wall(half, 0.0, -DVec2::X)]
}

/// Returns discs of random sizes for a box that is open above and `width` diameters wide. The discs fill the box row by
/// row from below, without contacts, on a randomly disturbed lattice.
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

/// Returns the mean kinetic energy of a disc in the present state, in m g d (weight of a disc times mean diameter).
pub(super) fn mean_energy(simulation: &Simulation) -> f64 {
    let world = simulation.world();
    let mass: f64 = world.grains.masses.iter().sum();
    let unit = mass * world.gravity.magnitude() * world.mean_diameter;
    simulation.observables().kinetic_energy / unit
}

pub(super) fn centre_of_mass(simulation: &Simulation) -> DVec2 {
    let grains = &simulation.world().grains;
    let mass: f64 = grains.masses.iter().sum();
    let pairs = grains.masses.iter().zip(&grains.positions);
    pairs.map(|(mass, place)| *mass * *place).sum::<DVec2>() / mass
}

/// Returns the solid fraction in a region: the total area of the grains in the region, divided by the total area of
/// their cells. The cell of a grain is the region nearer to it than to any other grain. Grains count if `is_inside` is
/// true for their centres and their cells are closed, which means that they are not at a free surface or a hole.
pub(super) fn solid_fraction(moment: &Moment, is_inside: impl Fn(DVec2) -> bool) -> f64 {
    let (mut discs, mut cells) = (0.0, 0.0);
    for (grain, measures) in moment.grains.iter().zip(&measure(moment).grains) {
        if is_inside(grain.position) && measures.solid_fraction.is_finite() {
            discs += PI * grain.radius * grain.radius;
            cells += measures.cell_area;
        }
    }
    discs / cells
}
