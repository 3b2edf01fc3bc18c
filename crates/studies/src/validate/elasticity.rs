//! Validates the apparent elasticity of rigid discs in Contact Dynamics if the steps are not solved accurately (T.
//! Unger, L. Brendel, D. E. Wolf, J. Kertész, Phys. Rev. E 65, 061305, 2002).
//!
//! Discs of mass m and diameter d form a row on a wall. In each step of length Δt, the solver makes N sweeps that start
//! from the impulses of the previous step. Consider a long wave along the row. Let v be the velocity amplitude of the
//! discs, and x the change of v per step that the present impulses cause, compared with the impulses at rest. Impulses
//! with x = −v would end the motion. The sweeps reduce the distance x + v from this solution by a factor S. So with x'
//! and v' after the step
//!
//! > x' = −v + S (x + v),  v' = v + x' = S (x + v),
//!
//! which is a matrix with trace 2S and determinant S. Its solution is a damped wave whose amplitude is multiplied by √S
//! in each step, and whose phase advances by θ per step, with cos θ = √S. On a wave of wave number k, sweeps act like
//! diffusion, S = exp(−q N (kd)²), with a coefficient q. For small kd this wave is the wave on a row of springs with
//! the stiffness κ = q m N/Δt² and dashpots with the coefficient γ = q m N/Δt, as found by Unger et al. Its propagation
//! speed is c = √(qN) d/Δt and its decay rate 1/τ = q N (kd)²/2Δt. So q can be computed both from the period and from
//! the damping of the wave. The longest wave on n discs has kd = π/2n.
//!
//! The value of q depends on the solver method. One parallel (Jacobi) sweep multiplies the wave by cos kd, so q = ½.
//! The method `jacobi` of this program splits the mass of a disc among its contacts, which halves q, because a disc has
//! two contacts. A row has no loops, so a sweep of Gauss–Seidel multiplies the wave by cos² kd if its order is the same
//! in every sweep (D. M. Young 1971), and q = 1.

use std::f64::consts::{FRAC_PI_2, TAU};

use super::experiment::*;
use super::fit::{DampedWave, damped_wave};
use crate::error::Result;
use crate::scene::stability::column_on_line;
use crate::solver::{Method, Ordering, SolverSettings};
use crate::statistics::slope;

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "elasticity",
    title: "Spurious elasticity",
    about: "A row of discs on a wall, N sweeps a step, impulses carried from step to step: it rings like an elastic, \
            damped rod, κ = q m N/Δt² (T. Unger, L. Brendel, D. E. Wolf, J. Kertész, Phys. Rev. E 65, 061305, 2002). \
            Orders of Slump that are the same in every sweep have q = 1 on a chain, whichever they are, and its \
            jacobi, which splits masses, half of the parallel sweep's ½.",
    cases: ExperimentCases::Own(cases),
    published: PUBLISHED,
    judge,
};

/// Time step, s. The number of steps per period of the wave does not depend on the time step. With a smaller time step,
/// the row sags less under gravity.
const TIME_STEP_SECS: f64 = 1e-4;
/// Gap below which neighbouring discs of the row are in contact, in diameters.
const TOUCHES_WITHIN: f64 = 1e-2;
/// Number of periods of the longest wave to wait until shorter waves have decayed, and number of periods in which the
/// wave is then measured.
const PERIODS: [f64; 2] = [1.0, 3.0];

/// A solver method, the order in which its sweeps visit the contacts, and the theoretical coefficient q with which its
/// sweeps spread velocities like diffusion.
#[derive(Clone, Copy, Debug)]
struct SweepVariant {
    method: Method,
    ordering: Ordering,
    /// Theoretical coefficient q of diffusion: one sweep spreads the velocities along a row of discs like diffusion,
    /// with this coefficient in units of d² (diameter squared). It is ½ if all contacts are updated simultaneously
    /// (Jacobi), and half of this value if the mass of a disc is split between its two contacts. It is 1 for
    /// Gauss–Seidel sweeps whose order is the same in every sweep, because a row has no loops (D. M. Young 1971: each
    /// sweep of Gauss–Seidel reduces an error as much as two of Jacobi).
    q: f64,
}

const VARIANTS: [SweepVariant; 3] = [
    sweeps(Method::Jacobi, Ordering::Interleaved, 0.25),
    sweeps(Method::Nsgs, Ordering::Interleaved, 1.0),
    sweeps(Method::Nsgs, Ordering::BottomUp, 1.0),
];

const fn sweeps(method: Method, ordering: Ordering, q: f64) -> SweepVariant {
    SweepVariant { method, ordering, q }
}

fn cases(effort: Effort) -> Vec<ExperimentCase> {
    let discs: &[usize] = effort.pick(&[20, 30, 40], &[30, 40, 50, 60, 80]);
    let sweeps: &[u32] = effort.pick(&[2, 8, 32], &[2, 4, 8, 16, 32]);
    let mut cases = Vec::new();
    for (number, variant) in VARIANTS.iter().enumerate() {
        for &discs in discs {
            for &sweeps in sweeps {
                let (of, count) = (number as f64, discs as f64);
                let at = [("variant", of), ("discs", count), ("sweeps", f64::from(sweeps))];
                let cost = steps(variant, discs, sweeps) * count;
                cases.push(ExperimentCase::new(&at, cost, move || ring(variant, discs, sweeps)));
            }
        }
    }
    cases
}

/// Returns the wave number k of the longest wave on a row of `discs` discs, times the diameter d.
fn wave_number(discs: usize) -> f64 {
    FRAC_PI_2 / discs as f64
}

/// Returns the theoretical number of steps per period of the longest wave on a row of discs, computed from the solver
/// method's diffusion coefficient q.
fn period(variant: &SweepVariant, discs: usize, sweeps: u32) -> f64 {
    let shrinkage = (-variant.q * f64::from(sweeps) * wave_number(discs).powi(2)).exp();
    TAU / shrinkage.sqrt().acos()
}

fn steps(variant: &SweepVariant, discs: usize, sweeps: u32) -> f64 {
    (PERIODS[0] + PERIODS[1]) * period(variant, discs, sweeps)
}

/// Simulates a row of discs that begins without contact impulses, so that gravity along the row excites the longest
/// wave. Measures the period of the wave, and the solver method's diffusion coefficient q, once from the period and
/// once from the damping.
fn ring(variant: &SweepVariant, discs: usize, sweeps: u32) -> Result<RunReadings> {
    let mut scene = column_on_line(discs);
    scene.gap_tolerance = TOUCHES_WITHIN * scene.mean_diameter;
    scene.parameters.time_step_secs = TIME_STEP_SECS;
    let solver = SolverSettings::to_residual(variant.method, f64::MIN_POSITIVE, sweeps);
    scene.solver = SolverSettings { ordering: variant.ordering, ..solver };
    let mut simulation = scene.simulation()?;
    // Shape of the longest wave: zero velocity at the wall, and no force at the free end.
    let k = wave_number(discs);
    let shape: Vec<f64> = (0..discs).map(|disc| (k * (disc as f64 + 0.5)).sin()).collect();
    let mut amplitudes = Vec::new();
    for _ in 0..steps(variant, discs, sweeps).ceil() as u64 {
        simulation.step()?;
        let velocities = simulation.world().grains.velocities.iter().zip(&shape);
        amplitudes.push(velocities.map(|(velocity, shape)| velocity.x * shape).sum());
    }
    let period = period(variant, discs, sweeps);
    let ringing = &amplitudes[(PERIODS[0] * period) as usize..];
    let DampedWave { angle, shrinkage } = damped_wave(ringing, (0.25 * period) as usize);
    let q = |shrinkage: f64| -shrinkage.ln() / (f64::from(sweeps) * k * k);
    let steps = amplitudes.len() as u64;
    Ok(RunReadings {
        readings: named([
            ("q_period", q(angle.cos().powi(2))),
            ("q_damping", q(shrinkage.powi(2))),
            ("period", TAU / angle),
        ]),
        simulated_secs: steps as f64 * TIME_STEP_SECS,
        steps,
        ..RunReadings::default()
    })
}

/// Table of published values as text, with one row for each quantity that the function [`judge`] computes from the
/// runs. A row has the form: name of the quantity | lower end of the band of values that agree, published value, upper
/// end of the band | kind of the source (`read`, `recalled`, `derived` or `exact`): source.
const PUBLISHED: &str = "
    q of jacobi, from the period | 0.245 0.25 0.255 | derived: half of ½ by mass splitting
    q of jacobi, from the damping | 0.245 0.25 0.255 | derived: half of ½ by mass splitting
    q of nsgs interleaved, from the period | 0.98 1 1.02 | derived: D. M. Young 1971: any fixed order on a chain
    q of nsgs interleaved, from the damping | 0.98 1 1.02 | derived: D. M. Young 1971: any fixed order on a chain
    q of nsgs bottom-up, from the period | 0.98 1 1.02 | derived: D. M. Young 1971: any fixed order on a chain
    q of nsgs bottom-up, from the damping | 0.98 1 1.02 | derived: D. M. Young 1971: any fixed order on a chain
    exponent of the period in N | -0.51 -0.5 -0.49 | read: Unger et al. 2002: T ∝ 1/√N
";

fn judge(all: &Measurements) -> Vec<Measured> {
    let system = format!("{} discs, N = {}", all.list("discs"), all.list("sweeps"));
    let (mut values, mut exponents) = (Vec::new(), Vec::new());
    for number in 0..VARIANTS.len() {
        let of_variant = all.with("variant", number as f64);
        values.extend(["q_period", "q_damping"].map(|reading| of_variant.readings(reading)));
        for discs in all.values("discs") {
            let of_row = of_variant.with("discs", discs);
            exponents.push(slope(
                &of_row.points(|case| (case.at("sweeps").ln(), case.reading("period").ln())),
            ));
        }
    }
    values.push(exponents);
    values.into_iter().map(|values| (system.clone(), values)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fixed_orders_have_one_and_split_masses_a_quarter() {
        for variant in &VARIANTS {
            let run = ring(variant, 24, 8).expect("a row that rings");
            for reading in ["q_period", "q_damping"] {
                let q = run.reading(reading);
                assert!((q / variant.q - 1.0).abs() < 0.03, "{variant:?} {reading}: {q}");
            }
        }
    }
}
