//! Drop and roll: the quick way to make a pile.
//!
//! Discs are dropped one by one, and each rolls until two others hold it ([`dropped`]). This packing carries itself
//! except for a few grains, because each of the two supports carries the weight of one side. Only the contact forces
//! are missing. They travel by about a layer per sweep, so the pile first sways up and down as a whole, for a number
//! of steps that grows with its layers. A medium damps this motion: with less damping the pile keeps swaying, with
//! more it creeps. Then the medium becomes thin, so that grains whose supports gave way can fall, and is removed
//! before the pile counts as at rest.

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

/// Number of random places tried per disc; the disc takes the lowest. With one try the deposit has slopes that
/// avalanche for many steps when the pile is released. More than a few change little.
const TRIES: usize = 4;
/// Fraction of its height by which a pile is compressed before it settles, so that all contacts touch. If smaller,
/// the errors of the first steps (gΔt² = 8e-5 d) open contacts; if larger, the remaining overlap is larger.
const PRESSED: f64 = 2e-4;
/// Time step of the settling, s. It stays constant: a longer step later would open the contacts again, because errors
/// proportional to its square exceed their overlaps.
const TIME_STEP_SECS: f64 = 2e-4;
/// Largest number of sweeps per step. Steps that start from each other's forces help the pile more than sweeps that
/// end one step well.
const SWEEPS: u32 = 20;
/// Relative change of the impulses at which the sweeps of a step stop.
const TOLERANCE: f64 = 1e-7;
/// Fraction of the velocities that the medium removes per step, times the number of layers: twice the frequency of
/// the slowest sway. With half of it the pile sways, with twice as much it creeps; both double the time.
const DAMPING_BY_LAYERS: f64 = 7.0;
/// Largest fraction that the medium removes per step.
const MOST_DAMPING: f64 = 0.2;
/// Median speed of the grains, in √(g·d), below which the pile no longer sways and the medium becomes thin.
const STILL_SPEED: f64 = 1e-3;
/// Terminal speed of a grain falling through the thin medium, in √(g·d).
const TERMINAL_SPEED: f64 = 0.5;
/// Mean kinetic energy of a grain, in m g d, below which the medium is removed. Without the medium, a pile that stays
/// below ten times this value is at rest.
const REST_ENERGY: f64 = 1e-7;
/// Speed, in √(g·d), above which a grain counts as falling. At rest at most one grain in [`GRAINS_A_MOVING_ONE`] is
/// faster.
const REST_SPEED: f64 = 1e-2;
/// Number of grains per moving grain allowed at rest. In a large pile some grain always tips over somewhere, so
/// waiting for the last would take longer the larger the pile.
const GRAINS_A_MOVING_ONE: usize = 10_000;
const STEPS_PER_LOOK: u32 = 10;
/// Number of steps after which the settling fails: a constant, and an addition per layer.
const LIMIT_STEPS: [f64; 2] = [10_000.0, 100.0];

/// Drops discs of the given radii (m, each above 0) one by one at random places between walls at ± `half_width` (m,
/// at least the largest radius) onto fixed discs. Returns their centres at rest, in order.
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

/// The medium that slows the grains.
#[derive(Clone, Copy)]
enum Medium {
    /// So thick that the pile does not sway.
    Thick {
        damping: f64,
    },
    /// So thin that grains can fall.
    Thin,
    None,
}

impl Medium {
    /// The fraction of the velocities removed per step.
    fn damping(self) -> f64 {
        match self {
            Self::Thick { damping } => damping,
            Self::Thin => TIME_STEP_SECS * GRAVITY / (TERMINAL_SPEED * (GRAVITY * DIAMETER).sqrt()),
            Self::None => 0.0,
        }
    }
}

/// Motion of the grains: speeds of their centres or rims in √(g·d), energy in m g d.
struct GrainSpeeds {
    energy: f64,
    /// Fastest grain, except for the few that may move.
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

    /// Speed relative to that of a pile at rest, the larger of the ratios by energy and by the fastest grain.
    fn over_rest(&self) -> f64 {
        (self.energy / REST_ENERGY).sqrt().max(self.fastest / REST_SPEED)
    }
}
