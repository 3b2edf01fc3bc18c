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

use std::f64::consts::{FRAC_PI_2, TAU};

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64;

use super::experiment::{
    Experiment, ExperimentCase, ExperimentCases, Measurements, PublishedQuantity, RunReadings,
    SourceKind, named,
};
use super::fit::{DampedWave, damped_wave};
use crate::error::Result;
use crate::scene::stability::column_on_line;
use crate::sim::{Advance, Settings, Simulation, Stage, StepResult, diffusion_of_sweep};
use crate::solver::{ContactSystem, Method, Model, Ordering, SolveReport, SolverSettings};
use crate::statistics::slope;

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "elasticity",
    title: "Spurious elasticity",
    about: "A row of discs on a wall, N sweeps a step, impulses carried from step to step: it rings like an elastic, \
            damped rod, κ = q m N/Δt² (T. Unger, L. Brendel, D. E. Wolf, J. Kertész, Phys. Rev. E 65, 061305, 2002). \
            Orders of Slump that are the same in every sweep have q = 1 on a chain, whichever they are, and its \
            jacobi, which splits masses, half of the parallel sweep's ½; the paper's parallel sweep and random order \
            are run beside them.",
    cases: ExperimentCases::Own(cases),
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

/// Who sweeps.
struct SweepVariant {
    name: &'static str,
    /// How far off q the mean of short rows may be, in q.
    within: f64,
    source: (SourceKind, &'static str),
    sweeper: Sweeper,
}

#[derive(Clone, Copy)]
enum Sweeper {
    /// A method of Slump.
    Of(Method, Ordering),
    /// All contacts at once.
    Parallel,
    /// One contact after the other, in an order drawn for each sweep.
    Random,
}

/// (4√e − 5)/2.
const OF_RANDOM_ORDER: f64 = 0.797_442_541_400_256_3;

impl SweepVariant {
    /// Whether the order is drawn for each sweep.
    fn is_random(&self) -> bool {
        matches!(self.sweeper, Sweeper::Random)
    }

    /// What q should be.
    fn q(&self) -> f64 {
        match self.sweeper {
            Sweeper::Of(method, _) => diffusion_of_sweep(method).unwrap_or(f64::NAN),
            Sweeper::Parallel => 0.5,
            Sweeper::Random => OF_RANDOM_ORDER,
        }
    }
}

const YOUNG: &str = "D. M. Young 1971: any fixed order on a chain";

const VARIANTS: [SweepVariant; 5] = [
    SweepVariant {
        name: "parallel sweep",
        within: 0.02,
        source: (SourceKind::Read, "Unger et al. 2002: ½"),
        sweeper: Sweeper::Parallel,
    },
    SweepVariant {
        name: "random order",
        within: 0.04,
        source: (SourceKind::Read, "Unger et al. 2002: (4√e − 5)/2"),
        sweeper: Sweeper::Random,
    },
    SweepVariant {
        name: "jacobi",
        within: 0.02,
        source: (SourceKind::Derived, "half of ½ by mass splitting"),
        sweeper: Sweeper::Of(Method::Jacobi, Ordering::Interleaved),
    },
    SweepVariant {
        name: "nsgs interleaved",
        within: 0.02,
        source: (SourceKind::Derived, YOUNG),
        sweeper: Sweeper::Of(Method::Nsgs, Ordering::Interleaved),
    },
    SweepVariant {
        name: "nsgs bottom-up",
        within: 0.02,
        source: (SourceKind::Derived, YOUNG),
        sweeper: Sweeper::Of(Method::Nsgs, Ordering::BottomUp),
    },
];

fn cases(quick: bool) -> Vec<ExperimentCase> {
    let discs: &[usize] = if quick { &[20, 30, 40] } else { &[30, 40, 50, 60, 80] };
    let sweeps: &[u32] = if quick { &[2, 8, 32] } else { &[2, 4, 8, 16, 32] };
    let mut cases = Vec::new();
    for (number, variant) in VARIANTS.iter().enumerate() {
        for &discs in discs {
            for &sweeps in sweeps {
                let (of, count) = (number as f64, discs as f64);
                let at = [("variant", of), ("discs", count), ("sweeps", f64::from(sweeps))];
                // Random order forms all velocities anew for each contact.
                let dearer = if variant.is_random() { 30.0 * DRAWS as f64 } else { 1.0 };
                let cost = dearer * steps(variant, discs, sweeps) * count;
                cases.push(ExperimentCase::new(&at, cost, move || ring(variant, discs, sweeps)));
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
fn period(variant: &SweepVariant, discs: usize, sweeps: u32) -> f64 {
    let shrinkage = (-variant.q() * f64::from(sweeps) * wave_number(discs).powi(2)).exp();
    TAU / shrinkage.sqrt().acos()
}

fn steps(variant: &SweepVariant, discs: usize, sweeps: u32) -> f64 {
    (PERIODS[0] + PERIODS[1]) * period(variant, discs, sweeps)
}

/// Lets a row ring, where the order is random many, and tells period and q of their mean wave: steps are linear in
/// impulses and velocities, so that it goes by the means of the sweeps.
fn ring(variant: &SweepVariant, discs: usize, sweeps: u32) -> Result<RunReadings> {
    let draws = if variant.is_random() { DRAWS } else { 1 };
    let mut waves = Vec::new();
    for draw in 1..=draws {
        let wave = wave(variant, discs, sweeps, draw)?;
        waves.resize(wave.len(), 0.0);
        waves.iter_mut().zip(wave).for_each(|(sum, amplitude)| *sum += amplitude);
    }
    let k = wave_number(discs);
    let period = period(variant, discs, sweeps);
    let ringing = &waves[(PERIODS[0] * period) as usize..];
    let DampedWave { angle, shrinkage } = damped_wave(ringing, (0.25 * period) as usize);
    let q = |shrinkage: f64| -shrinkage.ln() / (f64::from(sweeps) * k * k);
    let steps = draws * waves.len() as u64;
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

/// The amplitude of the longest wave of a row after each step.
fn wave(variant: &SweepVariant, discs: usize, sweeps: u32, draw: u64) -> Result<Vec<f64>> {
    let mut scene = column_on_line(discs);
    // No contact is lost where sweeps in random order shake the row.
    scene.gap_tolerance = TOUCHES_WITHIN * scene.mean_diameter;
    scene.parameters.time_step_secs = TIME_STEP_SECS;
    scene.solver = SolverSettings::to_residual(Method::Nsgs, f64::MIN_POSITIVE, sweeps);
    if let Sweeper::Of(method, ordering) = variant.sweeper {
        scene.solver = SolverSettings { method, ordering, ..scene.solver };
    }
    let mut simulation = scene.simulation()?;
    let random = variant.is_random().then(|| Pcg64::seed_from_u64(draw));
    let mut own = OwnSweeps { sweeps, random };
    // Its velocities: none at the wall, and no force at the free end.
    let k = wave_number(discs);
    let shape: Vec<f64> = (0..discs).map(|disc| (k * (disc as f64 + 0.5)).sin()).collect();
    let mut amplitudes = Vec::new();
    for _ in 0..steps(variant, discs, sweeps).ceil() as u64 {
        match variant.sweeper {
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

/// All contacts at once, or one after the other in random order.
struct OwnSweeps {
    sweeps: u32,
    /// What orders are drawn from; all contacts at once where there is none.
    random: Option<Pcg64>,
}

impl Advance for OwnSweeps {
    fn advance<M: Model>(&mut self, stage: &mut Stage<'_, M>, settings: &Settings) -> StepResult {
        stage.prepare(settings, |_approach| 0.0);
        let mut system = stage.system();
        let (mut impulses, mut velocities) = (Vec::new(), Vec::new());
        system.read(&mut impulses);
        let mut order: Vec<usize> = (0..system.len()).collect();
        for _ in 0..self.sweeps {
            let at_a_time = if let Some(random) = &mut self.random {
                order.shuffle(random);
                1
            } else {
                order.len().max(1)
            };
            for contacts in order.chunks(at_a_time) {
                system.velocities(&mut velocities);
                for &contact in contacts {
                    let [normal, _] = &mut impulses[contact];
                    *normal = (*normal - velocities[contact][0]).max(0.0);
                }
                system.write(&impulses);
            }
        }
        let report = SolveReport { sweeps: self.sweeps, ..SolveReport::default() };
        stage.move_by(report, settings)
    }
}

fn judge(all: &Measurements) -> Vec<PublishedQuantity> {
    let system = format!("{} discs, N = {}", all.list("discs"), all.list("sweeps"));
    let (mut quantities, mut exponents) = (Vec::new(), Vec::new());
    for (number, variant) in VARIANTS.iter().enumerate() {
        let of_variant = all.with("variant", number as f64);
        let band = [1.0 - variant.within, 1.0, 1.0 + variant.within].map(|part| variant.q() * part);
        for (reading, from) in [("q_period", "period"), ("q_damping", "damping")] {
            let name = format!("q of {}, from the {from}", variant.name);
            let values = of_variant.readings(reading);
            quantities.push(PublishedQuantity::new(name, &system, &values, band, variant.source));
        }
        for discs in all.values("discs") {
            let of_row = of_variant.with("discs", discs);
            exponents.push(slope(
                &of_row.points(|case| (case.at("sweeps").ln(), case.reading("period").ln())),
            ));
        }
    }
    quantities.push(PublishedQuantity::new(
        "exponent of the period in N",
        &system,
        &exponents,
        [-0.51, -0.5, -0.49],
        (SourceKind::Read, "Unger et al. 2002: T ∝ 1/√N"),
    ));
    quantities
}

#[cfg(test)]
mod tests {
    use super::*;

    /// q of a variant from the period and the damping of one row.
    fn q(variant: &SweepVariant, discs: usize, sweeps: u32) -> [f64; 2] {
        let run = ring(variant, discs, sweeps).expect("a row that rings");
        [run.reading("q_period"), run.reading("q_damping")]
    }

    #[test]
    fn a_row_under_parallel_sweeps_has_the_q_of_one_half_exactly() {
        let (variant, discs) = (&VARIANTS[0], 24);
        let k = wave_number(discs);
        // Of so long a wave the exact shrinkage of a sweep is cos kd.
        let exact = -k.cos().ln() / (k * k);
        assert!((exact - 0.5).abs() < 1e-3);
        for sweeps in [2, 8] {
            let [from_period, from_damping] = q(variant, discs, sweeps);
            assert!((from_period / exact - 1.0).abs() < 1e-3, "{from_period}");
            assert!((from_damping / exact - 1.0).abs() < 1e-3, "{from_damping}");
        }
    }

    #[test]
    fn fixed_orders_have_one_random_ones_less_and_split_masses_a_quarter() {
        for variant in &VARIANTS[1..] {
            let [from_period, _] = q(variant, 24, 8);
            assert!(
                (from_period / variant.q() - 1.0).abs() < 0.03,
                "{}: {from_period}",
                variant.name
            );
        }
    }
}
