//! Plane shear of cohesive grains: what cohesion does to friction and solid fraction at one inertial number.
//!
//! Grains that pull with C₀ under the pressure P have a second number besides I, η = C₀/(P d). With C₀ = Bond·m g/2 of two
//! grains of mass m, and P in units of m g/d, η = Bond/(2P).

use super::experiment::{Case, Cases, Experiment, Found, values, with};
use super::plane_shear::{Layer, PRESSURE, balance, size, takes_drives};
use super::quantity::{Provenance, Quantity};
use super::way::Way;
use crate::statistics::mean;

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "cohesive-shear",
    title: "Cohesive plane shear",
    about: "The same at I ≈ 0.08 with cohesion, η = C₀/(P d): weak cohesion dilates and leaves friction as it is; from \
            some strength on friction rises, and the solid fraction falls further (P. Rognon et al., Europhys. Lett. \
            74, 644, 2006). That it is so was read, where weak ends and what number each has was not, so that signs and \
            rough sizes alone are tested. Methods that take no driven walls are left out.",
    cases: Cases::Chosen(cases),
    judge,
};

/// I that is aimed at.
const INERTIAL: f64 = 0.08;
/// η that is weak, and η that is strong.
const WEAK: f64 = 1.0;
const STRONG: f64 = 30.0;

fn cases(quick: bool, way: Way) -> Vec<Case> {
    if !takes_drives(way) {
        return Vec::new();
    }
    let (cell, seeds) = size(quick);
    let strengths: &[f64] =
        if quick { &[0.0, WEAK, STRONG] } else { &[0.0, 0.3, WEAK, 3.0, 10.0, STRONG, 60.0] };
    let mut cases = Vec::new();
    for &strength in strengths {
        for seed in 1..=seeds {
            let bond = 2.0 * PRESSURE * strength;
            let layer = Layer { cell, inertial: INERTIAL, bond, seed: u64::from(seed) };
            cases.push(layer.case(("strength", strength), way));
        }
    }
    cases
}

fn judge(found: &[Found]) -> Vec<Quantity> {
    let grains = found.first().map_or(0.0, |one| one.at("grains"));
    let seeds = values(found, "seed");
    let list: Vec<String> = values(found, "strength").iter().map(f64::to_string).collect();
    let system = format!("{grains} grains, η = {}, {} seeds", list.join(", "), seeds.len());
    // Each layer against that of the same seed without cohesion.
    let against = |strength: f64, reading: &str, of: fn(f64, f64) -> f64| {
        let at = |seed: f64, strength: f64| {
            let mut runs = with(found, "seed", seed);
            runs.find(|one| one.at("strength") == strength)
                .map_or(f64::NAN, |one| one.reading(reading))
        };
        let pairs = seeds.iter().map(|&seed| of(at(seed, strength), at(seed, 0.0)));
        mean(&pairs.collect::<Vec<_>>())
    };
    let (ratio, difference) = (|with, without| with / without, |with, without| with - without);
    let quantity = |name: &str, measured, band, source| {
        Quantity::new(name, &system, measured, band, (Provenance::Memory, source))
    };
    vec![
        quantity(
            "T/N at η = 1 over that without cohesion",
            against(WEAK, "friction", ratio),
            [0.85, 1.0, 1.2],
            "Rognon et al. 2006: weak cohesion leaves it",
        ),
        quantity(
            "φ at η = 1 less that without cohesion",
            against(WEAK, "solid_fraction", difference),
            [-0.04, -0.01, 0.0],
            "Rognon et al. 2006: weak cohesion dilates",
        ),
        quantity(
            "T/N at η = 30 over that without cohesion",
            against(STRONG, "friction", ratio),
            [1.2, 2.0, f64::INFINITY],
            "Rognon et al. 2006: strong cohesion raises it",
        ),
        quantity(
            "φ at η = 30 less that without cohesion",
            against(STRONG, "solid_fraction", difference),
            [f64::NEG_INFINITY, -0.1, -0.02],
            "Rognon et al. 2006: strong cohesion dilates further",
        ),
        balance(found, ("strength", &system)),
    ]
}
