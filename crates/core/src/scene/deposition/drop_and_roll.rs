//! Drop and roll: a quick method to generate a pile.
//!
//! Discs are dropped one by one, and each rolls until two other bodies support it ([`dropped`]). Almost all grains of
//! this packing are in stable positions, with one support on either side of the grain's centre. Only the contact
//! forces are missing when the simulation begins. They spread by about one layer of grains per sweep of the solver, so
//! the pile first oscillates up and down as a whole, for a number of steps that grows with the number of its layers. A
//! medium, which reduces all velocities in each step, damps this motion. With less damping the pile keeps oscillating,
//! and with more it creeps. When the pile no longer oscillates, the medium becomes thin, so that grains that have lost
//! their supports can fall. The medium is removed before the pile counts as at rest.

use glam::DVec2;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::error::Result;
use crate::scene::deposition::rolling::{Deposit, dropped};
use crate::scene::deposition::{
    REST_SECS, Settled, Settling, in_a_box, interrupted, kinetic_energy, not_at_rest,
    random_radius, speeds,
};
use crate::scene::new_pile::NewPile;
use crate::scene::paper::{DIAMETER, GRAVITY, rough_base};
use crate::sim::Simulation;
use crate::solver::SolverSettings;
use crate::world::{Disc, Grain, Parameters};

/// Number of random drop positions that are tried for each disc. Of these, the disc takes the one at which it comes to
/// rest lowest. With one trial, the deposit has slopes that avalanche for many steps when the simulation begins. More
/// than a few trials change little.
const TRIES: usize = 4;
/// Fraction of the height by which a pile is compressed before it settles, so that all contacts touch. With a smaller
/// fraction, the position errors of the first steps open contacts. Such an error is about gΔt² = 8e-5 d, with gravity
/// g, the time step Δt = 2e-4 s and the mean diameter d. With a larger fraction, the overlaps that remain at rest are
/// larger.
const PRESSED: f64 = 2e-4;
/// Time step while the pile settles, s. It stays constant. If it were made longer when the pile is nearly at rest,
/// contacts would open again, because the position errors of a step are proportional to the square of its length and
/// would exceed the overlaps.
const TIME_STEP_SECS: f64 = 2e-4;
/// Largest number of sweeps of the solver per step. Many steps, each of which starts from the contact forces of the
/// previous step, bring the pile to rest faster than many sweeps in each step.
const SWEEPS: u32 = 20;
/// Tolerance of the solver: the solve of a step stops when a sweep changes the contact impulses by less than this
/// fraction of their size.
const TOLERANCE: f64 = 1e-7;
/// Damping of a settling pile by the thick medium (the strong damping that acts first): the fraction by which the
/// medium reduces all velocities per step, multiplied by the number of layers of grains in the pile. The value is twice
/// the frequency of the slowest oscillation of the pile, in the same unit: per step, times the number of layers. With
/// half of this value the pile oscillates, and with twice the value it creeps. Both double the time to settle.
const DAMPING_BY_LAYERS: f64 = 7.0;
/// Largest fraction by which the thick medium (the strong damping that acts first on a settling pile) reduces the
/// velocities per step. It applies to piles of fewer than 35 layers, for which [`DAMPING_BY_LAYERS`] divided by the
/// number of layers is larger.
const MOST_DAMPING: f64 = 0.2;
/// Median speed of the grains, in √(g·d) (g: gravity, d: mean diameter), below which the pile no longer oscillates.
/// Then the medium that damps all velocities becomes thin.
const STILL_SPEED: f64 = 1e-3;
/// Terminal speed of a grain that falls through the thin medium (the weak damping that acts on a pile that no longer
/// oscillates), in √(g·d) (g: gravity, d: mean diameter). In rain, the other method of generating a pile, the terminal
/// speed is the same.
const TERMINAL_SPEED: f64 = 0.5;
/// Mean kinetic energy of a grain, in m g d (mass, gravity, mean diameter), below which the medium that damps all
/// velocities is removed if no grain falls. After that, the pile is at rest if its energy stays below ten times this
/// value.
const REST_ENERGY: f64 = 1e-7;
/// Speed, in √(g·d) (g: gravity, d: mean diameter), above which a grain counts as falling. A pile counts as at rest if
/// at most one of [`GRAINS_A_MOVING_ONE`] grains is faster.
const REST_SPEED: f64 = 1e-2;
/// Number of grains of a pile for each grain that may still move when the pile counts as at rest. In a large pile,
/// grains somewhere always tip over, so waiting for the last grain would take longer the larger the pile is.
const GRAINS_A_MOVING_ONE: usize = 10_000;
const STEPS_PER_LOOK: u32 = 10;
/// Number of steps after which the generation of a pile that is not at rest fails: a constant, and an addition per
/// layer of grains.
const LIMIT_STEPS: [f64; 2] = [10_000.0, 100.0];

/// Drops discs one by one at random positions between two walls at ±`half_width` onto the fixed discs `base`, and lets
/// each roll until other bodies support it. Returns the discs in their final positions, in the order of `radii`. The
/// radii are in m and above 0. `half_width` is in m and at least the largest radius.
pub fn drop_and_roll(
    radii: &[f64],
    base: &[Disc],
    half_width: f64,
    random: &mut Pcg64,
) -> Vec<Disc> {
    let fixed = base.iter().map(|disc| disc.radius);
    let largest = radii.iter().copied().chain(fixed).fold(0.0, f64::max);
    let mut deposit = Deposit::new(-largest, half_width, largest);
    let is_within_reach = |disc: &&Disc| disc.position.x.abs() <= half_width + 2.0 * largest;
    base.iter().filter(is_within_reach).for_each(|&disc| deposit.add(disc));
    let fixed = deposit.discs().len();
    for &radius in radii {
        let room = half_width - radius;
        let mut lowest = DVec2::INFINITY;
        for _ in 0..TRIES {
            let centre = dropped(&deposit, random.random_range(-room..=room), radius).centre;
            lowest = if centre.y < lowest.y { centre } else { lowest };
        }
        deposit.add(Disc { position: lowest, radius });
    }
    deposit.discs()[fixed..].to_vec()
}

pub(super) fn start_of(pile: &NewPile) -> Vec<Grain> {
    let mut random = Pcg64::seed_from_u64(pile.seed);
    let radii: Vec<f64> = (0..pile.grains).map(|_| random_radius(pile, &mut random)).collect();
    let width = pile.box_width_in_diameters;
    let base = rough_base(width + 2.0 * pile.sizes.largest(), DIAMETER);
    let discs = drop_and_roll(&radii, &base, 0.5 * width * DIAMETER, &mut random);
    discs.into_iter().map(|Disc { position, radius }| Grain::at_rest(position, radius)).collect()
}

pub(super) fn settled(
    pile: &NewPile,
    mut progress: impl FnMut(Settling) -> bool,
) -> Result<Settled> {
    let mut grains = start_of(pile);
    for grain in &mut grains {
        grain.position.y *= 1.0 - PRESSED;
    }
    let layers = grains.iter().map(|grain| grain.position.y).fold(0.0, f64::max) / DIAMETER;
    let solver =
        SolverSettings { tolerance: TOLERANCE, max_sweeps: SWEEPS, ..SolverSettings::SWEEPS };
    let scene = in_a_box(grains, pile.box_width_in_diameters, TIME_STEP_SECS, solver)?;
    let mut simulation = scene.simulation()?;
    let law = *simulation.parameters();
    simulation.set_parameters(Parameters { restitution: 0.0, ..law })?;

    let limit_secs = TIME_STEP_SECS * (LIMIT_STEPS[0] + LIMIT_STEPS[1] * layers);
    let mut medium = Medium::Thick { damping: (DAMPING_BY_LAYERS / layers).min(MOST_DAMPING) };
    let mut rest_steps = 0;
    loop {
        for _ in 0..STEPS_PER_LOOK {
            simulation.step()?;
            simulation.scale_velocities(1.0 - medium.damping());
        }
        let speeds_now = GrainSpeeds::of(&simulation);
        let time_secs = simulation.time_secs();
        let settling = Settling {
            simulation: &simulation,
            rains: false,
            time_secs,
            limit_secs,
            speed_over_rest: speeds_now.over_rest(),
        };
        if !progress(settling) {
            return Err(interrupted());
        }
        let goes = match medium {
            Medium::Thick { .. } if speeds_now.median_speed <= STILL_SPEED => Medium::Thin,
            Medium::Thin if speeds_now.is_at_rest(REST_ENERGY) => {
                simulation.set_parameters(law)?;
                Medium::None
            }
            stays => stays,
        };
        rest_steps = match medium {
            Medium::None if speeds_now.is_at_rest(10.0 * REST_ENERGY) => {
                rest_steps + STEPS_PER_LOOK
            }
            _ => 0,
        };
        medium = goes;
        if f64::from(rest_steps) * TIME_STEP_SECS >= REST_SECS {
            return Ok(Settled::of(simulation));
        }
        if time_secs > limit_secs {
            return Err(not_at_rest(speeds_now.over_rest(), limit_secs));
        }
    }
}

/// The medium that damps the velocities of the grains while the pile settles: thick at first, then thin, then none.
#[derive(Clone, Copy)]
enum Medium {
    /// Medium that damps all velocities so strongly that the pile cannot oscillate up and down as a whole.
    Thick {
        damping: f64,
    },
    /// Medium that damps all velocities so weakly that grains can fall through it.
    Thin,
    None,
}

impl Medium {
    /// Returns the fraction by which this medium, in which the pile settles, reduces all velocities per step.
    fn damping(self) -> f64 {
        match self {
            Self::Thick { damping } => damping,
            Self::Thin => TIME_STEP_SECS * GRAVITY / (TERMINAL_SPEED * (GRAVITY * DIAMETER).sqrt()),
            Self::None => 0.0,
        }
    }
}

/// Measures of the motion of all grains: their mean kinetic energy, in m g d, and their largest and median speed, in
/// √(g·d), with the mass m of a grain, gravity g and the mean diameter d. The speed of a grain is the larger of the
/// speeds of its centre and its rim.
struct GrainSpeeds {
    energy: f64,
    /// Speed of the fastest grain, in √(g·d) (g: gravity, d: mean diameter). The few grains that may still move in a
    /// pile at rest are left out.
    fastest: f64,
    median_speed: f64,
}

impl GrainSpeeds {
    fn of(simulation: &Simulation) -> Self {
        let unit = (GRAVITY * DIAMETER).sqrt();
        let mut speeds: Vec<f64> = speeds(simulation).collect();
        let last = speeds.len() - 1 - speeds.len() / GRAINS_A_MOVING_ONE;
        let (slower, &mut fastest, _) = speeds.select_nth_unstable_by(last, f64::total_cmp);
        let median = match slower.len() / 2 {
            0 => fastest,
            middle => *slower.select_nth_unstable_by(middle, f64::total_cmp).1,
        };
        let energy = kinetic_energy(simulation);
        Self { energy, fastest: fastest / unit, median_speed: median / unit }
    }

    fn is_at_rest(&self, energy: f64) -> bool {
        self.energy <= energy && self.fastest <= REST_SPEED
    }

    /// Returns a ratio that shows how far the pile is from rest. It is the larger of two numbers: the speed of the
    /// fastest grain divided by its limit [`REST_SPEED`], and the square root of the kinetic energy divided by its
    /// limit [`REST_ENERGY`]. The limits are met if the ratio is at most 1.
    fn over_rest(&self) -> f64 {
        (self.energy / REST_ENERGY).sqrt().max(self.fastest / REST_SPEED)
    }
}
