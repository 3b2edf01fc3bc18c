//! Validates a gas of discs that cools by collisions with a constant restitution e (P. K. Haff, J. Fluid Mech. 134,
//! 401, 1983).
//!
//! Let T = ½ m⟨v²⟩ be the temperature in the plane, with the mass m and the mean square velocity ⟨v²⟩ of a disc. Each
//! collision dissipates (1 − e²) T on average: the relative velocity of two discs along the normal has the variance
//! 2T/m, its mean square over collisions is 4T/m, and a collision loses the energy ¼ m (1 − e²) times this mean square.
//! A disc collides ω = 2√π n d χ √(T/m) times per second (Enskog), with n discs of diameter d per area, and the pair
//! correlation at contact χ = (1 − 7φ/16)/(1 − φ)² at the solid fraction φ (D. Henderson 1975). Each collision counts
//! for two discs. For N discs with the energy E = N T, dE/dt = −N √π n d χ (1 − e²) T √(T/m).
//!
//! The walls have the same restitution as the discs. A unit length of wall is hit n_w √(T/2πm) times per second. Here
//! n_w = n (1 + 2φχ) is the number of discs per area next to the wall, which follows from the pressure on the wall. For
//! discs that hit the wall with the normal velocity v_n, ½ m ⟨v_n²⟩ = T, and a hit loses (1 − e²) T on average. With
//! the length L_w of the walls, measured along the line that the centres of touching discs can reach, the total loss is
//!
//! > dT/dt = −2 T √(T/T₀)/τ,  2/τ = (1 − e²) √(T₀/m) (√π n d χ + L_w n_w/(√(2π) N)),
//!
//! with the temperature T₀ at the time t = 0, so that T = T₀/(1 + t/τ)². The distribution of velocities stays close to
//! Maxwell's: at e = 0.9 its fourth cumulant is −0.03, which changes the cooling rate by half a per cent (T. P. C. van
//! Noije, M. H. Ernst 1998).

use std::f64::consts::{PI, TAU};

use glam::DVec2;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::experiment::*;
use super::fit::cooling_law;
use super::variants::StepVariant;
use super::watched::{WatchedRun, wall};
use crate::error::Result;
use crate::scene::Scene;
use crate::scene::stability::{DIAMETER, dry};
use crate::statistics::slope;
use crate::world::{Grain, Gravity, Physics};

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "cooling",
    title: "Cooling gas",
    about: "Discs without friction and gravity in a box, e = 0.9, solid fraction 0.1: before clusters form the \
            temperature falls as T₀/(1 + t/τ)² (P. K. Haff, J. Fluid Mech. 134, 401, 1983). τ is that of kinetic \
            theory in the plane (Enskog's collision rate), with what is lost at the walls, which are as inelastic as \
            the discs.",
    cases: ExperimentCases::Chosen(cases),
    published: PUBLISHED,
    judge,
};

pub(super) const RESTITUTION: f64 = 0.9;
const SOLID_FRACTION: f64 = 0.1;
/// Thermal speed √(2T₀/m) at the start, m/s, with the initial temperature T₀ and the mass m of a disc. At this speed a
/// disc moves by 1e-4 m, a hundredth of its diameter, in 1e-3 s.
pub(super) const THERMAL_SPEED: f64 = 0.1;
/// Duration of a run, in units of the cooling time τ of Haff's law, by which the temperature T of a gas falls with the
/// time t as T = T₀/(1 + t/τ)² from its initial value T₀.
const TIMES: f64 = 6.0;
/// Number of simulated times at which the temperature is measured in a run.
const MOMENTS: u32 = 120;

fn cases(effort: Effort, variant: StepVariant) -> Vec<ExperimentCase> {
    let (discs, seeds) = effort.pick((400, 4), (2_000, 10));
    let count = f64::from(discs);
    let cost = count * TIMES * time_secs(count) / variant.time_step_secs;
    seeded(&[count], seeds, |count, seed| {
        let at = [("discs", count), ("seed", seed as f64)];
        ExperimentCase::new(&at, cost, move || cool(discs as usize, seed, variant))
    })
}

/// Returns the side length of the square box in which `discs` discs have the solid fraction of the experiment, m.
pub(super) fn side(discs: f64) -> f64 {
    (discs * 0.25 * PI * DIAMETER * DIAMETER / SOLID_FRACTION).sqrt()
}

/// Returns the pair correlation χ of the discs at contact, dimensionless: the factor by which collisions are more
/// frequent than in a dilute gas.
fn contact_value() -> f64 {
    (1.0 - 7.0 / 16.0 * SOLID_FRACTION) / (1.0 - SOLID_FRACTION).powi(2)
}

/// Returns √π n d χ, 1/m, with n discs of diameter d per area and the pair correlation χ at contact. Multiplied by the
/// speed √(T/m), with the temperature T (an energy) and the mass m of a disc, this is the number of collisions per
/// second, divided by the number of discs.
pub(super) fn collisions_per_distance(discs: f64) -> f64 {
    PI.sqrt() * discs / side(discs).powi(2) * DIAMETER * contact_value()
}

/// Returns the theoretical cooling time τ of Haff's law, s. By this law, the temperature T of a gas falls with the time
/// t as T = T₀/(1 + t/τ)² from its initial value T₀. The collisions with the walls are included.
fn time_secs(discs: f64) -> f64 {
    let at_wall = discs / side(discs).powi(2) * (1.0 + 2.0 * SOLID_FRACTION * contact_value());
    let of_walls = 4.0 * (side(discs) - DIAMETER) * at_wall / (TAU.sqrt() * discs);
    let root = THERMAL_SPEED / 2f64.sqrt();
    2.0 / ((1.0 - RESTITUTION.powi(2)) * root * (collisions_per_distance(discs) + of_walls))
}

/// Returns a scene with discs on a regular grid in a square box, without gravity. Their initial velocities are drawn
/// from Maxwell's distribution.
pub(super) fn gas(discs: usize, seed: u64) -> Scene {
    let side = side(discs as f64);
    let columns = (discs as f64).sqrt().ceil();
    let spacing = side / columns;
    let mut random = Pcg64::seed_from_u64(seed);
    let mut normal = || {
        // Two normally distributed numbers, by the method of G. E. P. Box and M. E. Muller (1958).
        let (radius, angle) = (random.random_range(0.0..1.0f64), random.random_range(0.0..TAU));
        (-2.0 * (1.0 - radius).ln()).sqrt() * DVec2::from_angle(angle)
    };
    let grain = |index: usize| {
        let place = DVec2::new(index as f64 % columns, (index as f64 / columns).floor());
        let position = spacing * (place + 0.5) - 0.5 * side;
        let velocity = THERMAL_SPEED / 2f64.sqrt() * normal();
        Grain { velocity, ..Grain::at_rest(position, 0.5 * DIAMETER) }
    };
    let mut scene = dry("cooling", (0..discs).map(grain).collect());
    scene.physics = Physics { axes: 2, friction: false, rotation: false, cohesion: false };
    scene.gravity = Gravity::Uniform { acceleration: DVec2::ZERO };
    scene.parameters.restitution = RESTITUTION;
    let half = 0.5 * side / DIAMETER;
    scene.boundaries = vec![
        wall(-half, 0.0, DVec2::X),
        wall(half, 0.0, -DVec2::X),
        wall(0.0, -half, DVec2::Y),
        wall(0.0, half, -DVec2::Y),
    ];
    scene
}

fn cool(discs: usize, seed: u64, variant: StepVariant) -> Result<RunReadings> {
    let mut scene = gas(discs, seed);
    variant.apply(&mut scene);
    let tau = time_secs(discs as f64);
    scene.duration_secs = TIMES * tau;
    let mut run = WatchedRun::start(&scene)?;
    let start = run.simulation.observables().kinetic_energy;
    let mut points = vec![(0.0, 1.0)];
    for moment in 1..=MOMENTS {
        run.run_until(f64::from(moment) / f64::from(MOMENTS) * scene.duration_secs, |_| ())?;
        let simulation = &run.simulation;
        points.push((simulation.time_secs(), simulation.observables().kinetic_energy / start));
    }
    let [exponent, _] = cooling_law(&points);
    // The initial energy E is computed from the velocities that were drawn, because it differs from the mean energy of
    // their distribution. The cooling time τ scales with 1/√E.
    let mass: f64 = run.simulation.world().grains.masses.iter().sum();
    let expected = tau * THERMAL_SPEED / (2.0 * start / mass).sqrt();
    // By Haff's law 1/√T = (1 + t/τ)/√T₀, which is a straight line in the time t.
    let roots: Vec<(f64, f64)> = points.iter().map(|(t, energy)| (*t, energy.powf(-0.5))).collect();
    Ok(run.with([("exponent", exponent), ("time", 1.0 / slope(&roots) / expected)]))
}

/// Table of published values as text, with one row for each quantity that the function [`judge`] computes from the
/// runs. A row has the form: name of the quantity | lower end of the band of values that agree, published value, upper
/// end of the band | kind of the source (`read`, `recalled`, `derived` or `exact`): source.
const PUBLISHED: &str = "
    exponent p of T = T₀ (1 + t/τ)^−p | 1.85 2 2.15 | exact: Haff 1983
    τ over that of kinetic theory | 0.9 1 1.1 | recalled: Enskog's collision rate, Henderson 1975, walls included
";

fn judge(all: &Measurements) -> Vec<Measured> {
    let system = format!("{} discs, {} runs", all.first("discs"), all.0.len());
    ["exponent", "time"].map(|reading| (system.clone(), all.readings(reading))).into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::Stepper;
    use crate::solver::Method;
    use crate::validate::variants::SolveBudget;

    #[test]
    fn a_gas_cools_as_haff_says_and_slower_where_it_loses_less() {
        let budget = SolveBudget::Sweeps(10);
        let variant = StepVariant {
            stepper: Stepper::Moreau,
            method: Method::Nsgs,
            time_step_secs: 2e-3,
            budget,
        };
        let run = || cool(225, 3, variant).expect("a gas that stays finite");
        let time = run().reading("time");
        assert!((time - 1.0).abs() < 0.1, "{time}");
        assert_eq!(run().lost_grains, 0);
        // Two runs of the same gas are bitwise equal.
        assert_eq!(run().reading("time").to_bits(), time.to_bits());
    }
}
