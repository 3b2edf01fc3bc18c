//! The elasticity that Contact Dynamics has where steps are left unsolved (T. Unger, L. Brendel, D. E. Wolf,
//! J. Kertész, Phys. Rev. E 65, 061305, 2002).
//!
//! Discs stand in a row on a wall; a step is N sweeps from the impulses of the step before. Let x be what the present
//! impulses, less those of rest, do to the velocity of a long wave in a step, and v that velocity. Impulses −v would
//! end the motion. Sweeps bring x nearer to −v by a factor S, so that
//!
//! > x' = −v + S (x + v),  v' = v + x' = S (x + v),
//!
//! a matrix of trace 2S and determinant S: a damped wave that shrinks by √S a step and turns by θ, cos θ = √S. For a
//! wave of wave number k sweeps are diffusion, S = exp(−q N (kd)²): for small S this is the row of springs
//! κ = q m N/Δt² and dashpots γ = q m N/Δt of the paper, with c = √(qN) d/Δt and 1/τ = q N (kd)²/2Δt. So period and
//! damping each tell q. The longest wave on n discs has kd = π/2n.
//!
//! What q is: one parallel (Jacobi) sweep shrinks the wave by cos kd, so q = ½; with the mass splitting of `jacobi`
//! half of that, since a disc with two contacts is cut in two. A chain has no loops, so each order of Gauss–Seidel that
//! is the same in every sweep shrinks by cos² kd (D. M. Young 1971) and q = 1. In an order that is drawn anew for each
//! sweep q = (4√e − 5)/2 (the paper). Slump has no such order; it and the parallel sweep are methods of this file's own.

mod arms;
mod own_sweeps;

use std::f64::consts::{FRAC_PI_2, TAU};

use rand::SeedableRng;
use rand_pcg::Pcg64;

use self::arms::{ARMS, Arm, Sweeper};
use self::own_sweeps::OwnSweeps;
use super::experiment::{Case, Cases, Experiment, Found, Measured, Reading, values, with};
use super::fit::{DampedWave, damped_wave};
use super::quantity::{Provenance, Quantity};
use crate::error::Result;
use crate::scene::stability::column_on_line;
use crate::sim::Simulation;
use crate::solver::{Method, SolverSettings};
use crate::statistics::{mean, slope};

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "elasticity",
    title: "Spurious elasticity",
    about: "A row of discs on a wall, N sweeps a step, impulses carried from step to step: it rings like an elastic, \
            damped rod, κ = q m N/Δt² (T. Unger, L. Brendel, D. E. Wolf, J. Kertész, Phys. Rev. E 65, 061305, 2002). \
            Orders of Slump that are the same in every sweep have q = 1 on a chain, whichever they are, and its \
            jacobi, which splits masses, half of the parallel sweep's ½; the paper's parallel sweep and random order \
            are run beside them.",
    cases: Cases::Own(cases),
    judge,
};

/// Δt, s. Periods in steps do not depend on it; the smaller, the less the row sags.
const TIME_STEP_SECS: f64 = 1e-4;
/// Discs touch below this gap, in diameters.
const TOUCHES_WITHIN: f64 = 1e-2;
/// Periods that are waited for, so that shorter waves are gone, and that are looked at.
const PERIODS: [f64; 2] = [1.0, 3.0];

/// How many rows the mean wave is taken of where the order is random: single ones are shaken by it.
const DRAWS: u64 = 40;

fn cases(quick: bool) -> Vec<Case> {
    let discs: &[usize] = if quick { &[20, 30, 40] } else { &[30, 40, 50, 60, 80] };
    let sweeps: &[u32] = if quick { &[2, 8, 32] } else { &[2, 4, 8, 16, 32] };
    let mut cases = Vec::new();
    for (number, arm) in ARMS.iter().enumerate() {
        for &discs in discs {
            for &sweeps in sweeps {
                let at = vec![
                    ("arm", number as f64),
                    ("discs", discs as f64),
                    ("sweeps", f64::from(sweeps)),
                ];
                let run = move || ring(arm, discs, sweeps);
                // Random order forms all velocities anew for each contact.
                let dearer = if arm.is_random() { 30.0 * DRAWS as f64 } else { 1.0 };
                let cost = dearer * steps(arm, discs, sweeps) * discs as f64;
                cases.push(Case { at, cost, run: Box::new(run) });
            }
        }
    }
    cases
}

/// kd of the longest wave.
fn wave_number(discs: usize) -> f64 {
    FRAC_PI_2 / discs as f64
}

/// Steps of a period, as q has it.
fn period(arm: &Arm, discs: usize, sweeps: u32) -> f64 {
    let shrinkage = (-arm.q() * f64::from(sweeps) * wave_number(discs).powi(2)).exp();
    TAU / shrinkage.sqrt().acos()
}

fn steps(arm: &Arm, discs: usize, sweeps: u32) -> f64 {
    (PERIODS[0] + PERIODS[1]) * period(arm, discs, sweeps)
}

/// Lets a row ring, where the order is random many, and tells period and q of their mean wave: steps are linear in
/// impulses and velocities, so that it goes by the means of the sweeps.
fn ring(arm: &Arm, discs: usize, sweeps: u32) -> Result<Measured> {
    let draws = if arm.is_random() { DRAWS } else { 1 };
    let mut waves = Vec::new();
    for draw in 1..=draws {
        let wave = wave(arm, (discs, sweeps), draw)?;
        waves.resize(wave.len(), 0.0);
        waves.iter_mut().zip(wave).for_each(|(sum, amplitude)| *sum += amplitude);
    }
    let k = wave_number(discs);
    let period = period(arm, discs, sweeps);
    let ringing = &waves[(PERIODS[0] * period) as usize..];
    let DampedWave { angle, shrinkage } = damped_wave(ringing, (0.25 * period) as usize);
    let q = |shrinkage: f64| -shrinkage.ln() / (f64::from(sweeps) * k * k);
    let readings = [
        ("q_period", q(angle.cos().powi(2))),
        ("q_damping", q(shrinkage.powi(2))),
        ("period", TAU / angle),
    ];
    let reading = |(name, value): (&str, f64)| Reading { name: name.to_owned(), value };
    let steps = draws * waves.len() as u64;
    Ok(Measured {
        readings: readings.into_iter().map(reading).collect(),
        simulated_secs: steps as f64 * TIME_STEP_SECS,
        steps,
        ..Measured::default()
    })
}

/// The amplitude of the longest wave of a row after each step.
fn wave(arm: &Arm, (discs, sweeps): (usize, u32), draw: u64) -> Result<Vec<f64>> {
    let mut scene = column_on_line(discs);
    // No contact is lost where sweeps in random order shake the row.
    scene.gap_tolerance = TOUCHES_WITHIN * scene.mean_diameter;
    scene.parameters.time_step_secs = TIME_STEP_SECS;
    scene.solver = SolverSettings::to_residual(Method::Nsgs, f64::MIN_POSITIVE, sweeps);
    if let Sweeper::Of(method, ordering) = arm.sweeper {
        scene.solver = SolverSettings { method, ordering, ..scene.solver };
    }
    let mut simulation = scene.simulation()?;
    let random = arm.is_random().then(|| Pcg64::seed_from_u64(draw));
    let mut own = OwnSweeps { sweeps, random };
    // Its velocities: none at the wall, and no force at the free end.
    let k = wave_number(discs);
    let shape: Vec<f64> = (0..discs).map(|disc| (k * (disc as f64 + 0.5)).sin()).collect();
    let mut amplitudes = Vec::new();
    for _ in 0..steps(arm, discs, sweeps).ceil() as u64 {
        match arm.sweeper {
            Sweeper::Of(..) => simulation.step()?,
            Sweeper::Parallel | Sweeper::Random => simulation.step_by(&mut own)?,
        };
        amplitudes.push(amplitude(&simulation, &shape));
    }
    Ok(amplitudes)
}

fn amplitude(simulation: &Simulation, shape: &[f64]) -> f64 {
    let velocities = &simulation.world().grains.velocities;
    velocities.iter().zip(shape).map(|(velocity, shape)| velocity.x * shape).sum()
}

fn judge(found: &[Found]) -> Vec<Quantity> {
    let (discs, sweeps) = (values(found, "discs"), values(found, "sweeps"));
    let list = |values: &[f64]| values.iter().map(f64::to_string).collect::<Vec<_>>().join(", ");
    let system = format!("{} discs, N = {}", list(&discs), list(&sweeps));
    let mut quantities = Vec::new();
    let mut exponents = Vec::new();
    for (number, arm) in ARMS.iter().enumerate() {
        let of_arm: Vec<Found> = with(found, "arm", number as f64).cloned().collect();
        let band = [1.0 - arm.within, 1.0, 1.0 + arm.within].map(|factor| arm.q() * factor);
        for (reading, from) in [("q_period", "period"), ("q_damping", "damping")] {
            let measured = mean(&of_arm.iter().map(|one| one.reading(reading)).collect::<Vec<_>>());
            let name = format!("q of {}, from the {from}", arm.name);
            let of = (arm.provenance, arm.source);
            quantities.push(Quantity::new(name, &system, measured, band, of));
        }
        for &discs in &discs {
            let of_row = with(&of_arm, "discs", discs);
            let points: Vec<(f64, f64)> =
                of_row.map(|one| (one.at("sweeps").ln(), one.reading("period").ln())).collect();
            exponents.push(slope(&points));
        }
    }
    quantities.push(Quantity::new(
        "exponent of the period in N",
        &system,
        mean(&exponents),
        [-0.51, -0.5, -0.49],
        (Provenance::Read, "Unger et al. 2002: T ∝ 1/√N"),
    ));
    quantities
}

#[cfg(test)]
mod tests {
    use super::*;

    /// q of an arm from the period and the damping of one row.
    fn q(arm: &Arm, discs: usize, sweeps: u32) -> [f64; 2] {
        let measured = ring(arm, discs, sweeps).expect("a row that rings");
        [measured.readings[0].value, measured.readings[1].value]
    }

    #[test]
    fn a_row_under_parallel_sweeps_has_the_q_of_one_half_exactly() {
        let (arm, discs) = (&ARMS[0], 24);
        let k = wave_number(discs);
        // Of so long a wave the exact shrinkage of a sweep is cos kd.
        let exact = -k.cos().ln() / (k * k);
        assert!((exact - 0.5).abs() < 1e-3);
        for sweeps in [2, 8] {
            let [from_period, from_damping] = q(arm, discs, sweeps);
            assert!((from_period / exact - 1.0).abs() < 1e-3, "{from_period}");
            assert!((from_damping / exact - 1.0).abs() < 1e-3, "{from_damping}");
        }
    }

    #[test]
    fn fixed_orders_have_one_random_ones_less_and_split_masses_a_quarter() {
        for arm in &ARMS[1..] {
            let [from_period, _] = q(arm, 24, 8);
            assert!((from_period / arm.q() - 1.0).abs() < 0.03, "{}: {from_period}", arm.name);
        }
    }
}
