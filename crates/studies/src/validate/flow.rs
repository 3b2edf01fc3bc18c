//! A silo with a flat bottom: how fast grains flow out of an orifice of width W.
//!
//! Q ∝ ρ_b √g (W − k d)^{3/2} in the plane (W. A. Beverloo, H. A. Leniger, J. van de Velde 1961, in two dimensions). So
//! Q^{2/3} is linear in W and vanishes at k d. That Q goes with √g holds of rigid grains by dimensions alone.

use glam::DVec2;

use super::experiment::{Case, Cases, Experiment, Found, Measured, values, with};
use super::quantity::{Provenance, Quantity};
use super::spread::at_rest;
use super::start::{loose, settle};
use super::trial::Trial;
use super::way::Way;
use crate::error::Result;
use crate::scene::Scene;
use crate::scene::experiments::{SILO_WIDTH, silo_of};
use crate::scene::stability::{DIAMETER, GRAVITY, dry};
use crate::statistics::{mean, slope};
use crate::world::{Grain, Gravity};

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "silo",
    title: "Silo",
    about: "A silo 26 d wide with a flat bottom, μ = 0.5: discharge Q against the width W of its orifice, Q ∝ √g \
            (W − k d)^1.5 (W. A. Beverloo et al. 1961, in the plane), from the time between 8 and 40 % of the grains \
            out.",
    cases: Cases::Chosen(cases),
    judge,
};

/// μ.
const FRICTION: f64 = 0.5;
/// Parts of the mass that are out when the discharge is taken.
const OUT: [f64; 2] = [0.08, 0.4];
/// When the plate falls, s.
const RELEASE_SECS: f64 = 0.02;
/// The orifice at which gravity is varied, in diameters, and how many times it is.
const OF_GRAVITY: f64 = 8.0;
const TIMES_GRAVITY: f64 = 4.0;
/// k where the exponent is looked for.
const TAKEN_K: f64 = 1.4;

fn cases(quick: bool, way: Way) -> Vec<Case> {
    let (grains, seeds) = if quick { (450, 6u32) } else { (900, 8) };
    let orifices: &[f64] =
        if quick { &[6.0, 7.0, OF_GRAVITY, 10.0] } else { &[6.0, 7.0, OF_GRAVITY, 9.5, 11.0] };
    let mut wanted: Vec<(f64, f64)> = orifices.iter().map(|&orifice| (orifice, 1.0)).collect();
    wanted.push((OF_GRAVITY, TIMES_GRAVITY));
    let mut cases = Vec::new();
    for (orifice, times) in wanted {
        for seed in 1..=seeds {
            let at = vec![
                ("orifice", orifice),
                ("gravity", times),
                ("grains", f64::from(grains)),
                ("seed", f64::from(seed)),
            ];
            let run = move || discharge(orifice, times, (grains as usize, u64::from(seed)), way);
            let cost = f64::from(grains) * 5.0 / way.time_step_secs;
            cases.push(Case { at, cost, run: Box::new(run) });
        }
    }
    cases
}

fn full(grains: Vec<Grain>, times: f64) -> Scene {
    let mut scene = dry("silo", grains);
    scene.gravity = Gravity::Uniform { acceleration: -times * GRAVITY * DVec2::Y };
    scene.parameters.friction = FRICTION;
    scene.parameters.restitution_threshold = 2.0;
    scene.duration_secs = 60.0;
    scene
}

fn discharge(orifice: f64, times: f64, (grains, seed): (usize, u64), way: Way) -> Result<Measured> {
    let mut closed = silo_of(full(loose(grains, SILO_WIDTH, seed), times), orifice, RELEASE_SECS);
    closed.motions.clear();
    way.take(&mut closed);
    let mut settling = Trial::start(&closed)?;
    settle(&mut settling)?;
    let mut open = silo_of(full(at_rest(&settling.simulation), times), orifice, RELEASE_SECS);
    way.take(&mut open);
    let mut trial = Trial::start(&open)?;
    let all: f64 = trial.simulation.world().grains.masses.iter().sum();
    let mut course = Vec::new();
    // Some times what it takes: where it jams, there is no discharge.
    let limit_secs = 4.0 / times.sqrt();
    let mut part = 0.0;
    while part < OUT[1] && trial.simulation.time_secs() < limit_secs {
        let time_secs = trial.simulation.time_secs();
        trial.run_until(time_secs + 5.0 * way.time_step_secs, |_| ())?;
        let grains = &trial.simulation.world().grains;
        let below = grains.masses.iter().zip(&grains.positions).filter(|(_, place)| place.y < 0.0);
        part = below.map(|(mass, _)| mass).sum::<f64>() / all;
        if part >= OUT[0] {
            course.push((trial.simulation.time_secs(), part * all));
        }
    }
    let rate = if part < OUT[1] { f64::NAN } else { slope(&course) };
    // In σ d √(g d): σ is 1 kg/m².
    let unit = DIAMETER.powf(1.5) * GRAVITY.sqrt();
    Ok(trial.measured([("rate", rate / unit)]))
}

fn judge(found: &[Found]) -> Vec<Quantity> {
    let grains = found.first().map_or(0.0, |one| one.at("grains"));
    let seeds = values(found, "seed");
    let list: Vec<String> = values(found, "orifice").iter().map(f64::to_string).collect();
    let system = format!("{grains} grains, W = {} d, {} seeds", list.join(", "), seeds.len());
    let (mut offsets, mut exponents, mut ratios) = (Vec::new(), Vec::new(), Vec::new());
    for seed in seeds {
        let of_seed: Vec<Found> = with(found, "seed", seed).cloned().collect();
        let at_one: Vec<(f64, f64)> = with(&of_seed, "gravity", 1.0)
            .map(|one| (one.at("orifice"), one.reading("rate")))
            .collect();
        let roots: Vec<(f64, f64)> =
            at_one.iter().map(|(orifice, rate)| (*orifice, rate.powf(2.0 / 3.0))).collect();
        let middle = |axis: usize| {
            mean(&roots.iter().map(|point| [point.0, point.1][axis]).collect::<Vec<_>>()).mean
        };
        offsets.push(middle(0) - middle(1) / slope(&roots));
        let logarithms: Vec<(f64, f64)> =
            at_one.iter().map(|(orifice, rate)| ((orifice - TAKEN_K).ln(), rate.ln())).collect();
        exponents.push(slope(&logarithms));
        let at = |times: f64| {
            let mut runs = with(&of_seed, "gravity", times);
            runs.find(|one| one.at("orifice") == OF_GRAVITY)
                .map_or(f64::NAN, |one| one.reading("rate"))
        };
        ratios.push(at(TIMES_GRAVITY) / at(1.0));
    }
    let quantity =
        |name: &str, values: &[f64], band, of| Quantity::new(name, &system, mean(values), band, of);
    let memory = |source| (Provenance::Memory, source);
    vec![
        quantity(
            "k of (W − k d)",
            &offsets,
            [0.8, 1.4, 2.0],
            memory("Beverloo et al. 1961: 1.3 … 1.5"),
        ),
        quantity(
            "exponent of Q in W − 1.4 d",
            &exponents,
            [1.3, 1.5, 1.7],
            memory("Beverloo et al. 1961 in the plane: 1.5"),
        ),
        quantity(
            "Q at 4 g over that at g",
            &ratios,
            [1.9, 2.0, 2.1],
            (Provenance::Exact, "dimensions: Q ∝ √g"),
        ),
    ]
}
