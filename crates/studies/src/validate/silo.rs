//! Validates a silo with a flat bottom: the discharge rate Q of an orifice of width W.
//!
//! In the plane, Q ∝ ρ_b √g (W − k d)^{3/2} with the bulk density ρ_b, gravity g, the diameter d and a constant k (W.
//! A. Beverloo, H. A. Leniger, J. van de Velde 1961, in two dimensions). Therefore Q^{2/3} is linear in W and vanishes
//! at W = k d. For rigid grains, Q ∝ √g follows from dimensional analysis alone.

use glam::DVec2;

use super::experiment::*;
use super::fit::middle;
use super::variants::StepVariant;
use super::watched::{WatchedRun, at_rest, loose, settled};
use crate::error::Result;
use crate::scene::Scene;
use crate::scene::experiments::{SILO_WIDTH, silo_of};
use crate::scene::stability::{DIAMETER, GRAVITY, dry};
use crate::statistics::slope;
use crate::world::{Grain, Gravity};

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "silo",
    title: "Silo",
    about: "A silo 26 d wide with a flat bottom, μ = 0.5: discharge Q against the width W of its orifice, Q ∝ √g \
            (W − k d)^1.5 (W. A. Beverloo et al. 1961, in the plane), from the time between 8 and 40 % of the grains \
            out.",
    cases: ExperimentCases::Chosen(cases),
    published: PUBLISHED,
    judge,
};

const FRICTION: f64 = 0.5;
/// Discharged fractions of the total mass at which the measurement of the discharge rate begins and ends.
const OUT: [f64; 2] = [0.08, 0.4];
/// Simulated time at which the plate that closes the orifice is removed, s.
const RELEASE_SECS: f64 = 0.02;
/// Width of the silo's orifice in the test with stronger gravity, in diameters.
const OF_GRAVITY: f64 = 8.0;
/// Factor by which gravity is increased in the test with stronger gravity.
const TIMES_GRAVITY: f64 = 4.0;
/// Value of the constant k in the law Q ∝ (W − k d)^{3/2} that is assumed when the exponent 3/2 is measured. Q is the
/// discharge rate, W the width of the orifice and d the diameter.
const TAKEN_K: f64 = 1.4;

fn cases(effort: Effort, variant: StepVariant) -> Vec<ExperimentCase> {
    let (grains, seeds) = effort.pick((450, 6), (900, 8));
    let orifices: &[f64] =
        effort.pick(&[6.0, 7.0, OF_GRAVITY, 10.0], &[6.0, 7.0, OF_GRAVITY, 9.5, 11.0]);
    let mut flows: Vec<(f64, f64)> = orifices.iter().map(|&orifice| (orifice, 1.0)).collect();
    flows.push((OF_GRAVITY, TIMES_GRAVITY));
    let cost = f64::from(grains) * 5.0 / variant.time_step_secs;
    seeded(&flows, seeds, |(orifice, gravity), seed| {
        let count = f64::from(grains);
        let at =
            [("orifice", orifice), ("gravity", gravity), ("grains", count), ("seed", seed as f64)];
        let run = move || discharge(orifice, gravity, grains as usize, seed, variant);
        ExperimentCase::new(&at, cost, run)
    })
}

fn silo(grains: Vec<Grain>, orifice: f64, gravity: f64, variant: StepVariant) -> Scene {
    let mut scene = dry("silo", grains);
    scene.gravity = Gravity::Uniform { acceleration: -gravity * GRAVITY * DVec2::Y };
    scene.parameters.friction = FRICTION;
    scene.duration_secs = 60.0;
    let mut scene = silo_of(scene, orifice, RELEASE_SECS);
    variant.apply(&mut scene);
    scene
}

fn discharge(
    orifice: f64,
    gravity: f64,
    grains: usize,
    seed: u64,
    variant: StepVariant,
) -> Result<RunReadings> {
    let mut closed = silo(loose(grains, SILO_WIDTH, seed), orifice, gravity, variant);
    closed.motions.clear();
    let open = silo(at_rest(&settled(&closed)?), orifice, gravity, variant);
    let mut run = WatchedRun::start(&open)?;
    let all: f64 = run.simulation.world().grains.masses.iter().sum();
    let mut fallen = Vec::new();
    // The limit is several times the expected duration. If the flow jams, there is no discharge rate.
    let limit_secs = 4.0 / gravity.sqrt();
    let mut part = 0.0;
    while part < OUT[1] && run.simulation.time_secs() < limit_secs {
        let time_secs = run.simulation.time_secs();
        run.run_until(time_secs + 5.0 * variant.time_step_secs, |_| ())?;
        let grains = &run.simulation.world().grains;
        let below = grains.masses.iter().zip(&grains.positions).filter(|(_, place)| place.y < 0.0);
        part = below.map(|(mass, _)| mass).sum::<f64>() / all;
        if part >= OUT[0] {
            fallen.push((run.simulation.time_secs(), part * all));
        }
    }
    let rate = if part < OUT[1] { f64::NAN } else { slope(&fallen) };
    // The unit of the rate is σ d √(g d), with the diameter d, gravity g and the areal density σ = 1 kg/m².
    let unit = DIAMETER.powf(1.5) * GRAVITY.sqrt();
    Ok(run.with([("rate", rate / unit)]))
}

/// Table of published values as text, with one row for each quantity that the function [`judge`] computes from the
/// runs. A row has the form: name of the quantity | lower end of the band of values that agree, published value, upper
/// end of the band | kind of the source (`read`, `recalled`, `derived` or `exact`): source.
const PUBLISHED: &str = "
    k of (W − k d) | 0.8 1.4 2 | recalled: Beverloo et al. 1961: 1.3 … 1.5
    exponent of Q in W − 1.4 d | 1.3 1.5 1.7 | recalled: Beverloo et al. 1961 in the plane: 1.5
    Q at 4 g over that at g | 1.9 2 2.1 | exact: dimensions: Q ∝ √g
";

fn judge(all: &Measurements) -> Vec<Measured> {
    let (grains, orifices) = (all.first("grains"), all.list("orifice"));
    let system = format!("{grains} grains, W = {orifices} d, {}", all.seeds());
    let rates = |of_seed: Measurements, of: fn(f64, f64) -> (f64, f64)| -> Vec<(f64, f64)> {
        let at_one = of_seed.with("gravity", 1.0);
        at_one.points(|case| of(case.at("orifice"), case.reading("rate")))
    };
    let offsets = all.by_seed(|of_seed| {
        let roots = rates(of_seed, |orifice, rate| (orifice, rate.powf(2.0 / 3.0)));
        let (orifice, root) = middle(&roots);
        orifice - root / slope(&roots)
    });
    let exponents = all.by_seed(|of_seed| {
        slope(&rates(of_seed, |orifice, rate| ((orifice - TAKEN_K).ln(), rate.ln())))
    });
    let ratios = all.by_seed(|of_seed| {
        let at = |times| of_seed.with("gravity", times).with("orifice", OF_GRAVITY).reading("rate");
        at(TIMES_GRAVITY) / at(1.0)
    });
    [offsets, exponents, ratios].map(|values| (system.clone(), values)).into()
}
