//! Plane shear of cohesive grains: what cohesion does to friction and solid fraction at one inertial number.
//!
//! Grains that pull with C₀ under the pressure P have a second number besides I, η = C₀/(P d). With C₀ = Bond·m g/2 of two
//! grains of mass m, and P in units of m g/d, η = Bond/(2P).

use super::experiment::*;
use super::shear::{PRESSURE, balance, layers};
use super::variants::StepVariant;

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "cohesive-shear",
    title: "Cohesive plane shear",
    about: "The same at I ≈ 0.08 with cohesion, η = C₀/(P d): weak cohesion dilates and leaves friction as it is; from \
            some strength on friction rises, and the solid fraction falls further (P. Rognon et al., Europhys. Lett. \
            74, 644, 2006). That it is so was read, where weak ends and what number each has was not, so that signs and \
            rough sizes alone are tested. Methods that take no driven walls are left out.",
    cases: ExperimentCases::Chosen(cases),
    judge,
};

const INERTIAL: f64 = 0.08;
/// η that is weak, and η that is strong.
const WEAK: f64 = 1.0;
const STRONG: f64 = 30.0;

fn cases(quick: bool, variant: StepVariant) -> Vec<ExperimentCase> {
    let strengths: &[f64] =
        if quick { &[0.0, WEAK, STRONG] } else { &[0.0, 0.3, WEAK, 3.0, 10.0, STRONG, 60.0] };
    let layer = |&strength: &f64| (("strength", strength), INERTIAL, 2.0 * PRESSURE * strength);
    layers(quick, variant, &strengths.iter().map(layer).collect::<Vec<_>>())
}

fn judge(all: &Measurements) -> Vec<PublishedQuantity> {
    let (grains, strengths) = (all.first("grains"), all.list("strength"));
    let system = format!("{grains} grains, η = {strengths}, {}", all.seeds());
    // Each layer against that of the same seed without cohesion.
    let against = |strength: f64, reading: &str, of: fn(f64, f64) -> f64| {
        all.by_seed(|of_seed| {
            let at = |strength| of_seed.with("strength", strength).reading(reading);
            of(at(strength), at(0.0))
        })
    };
    let (ratio, difference) = (|with, without| with / without, |with, without| with - without);
    let quantity = |name: &str, values: Vec<f64>, band, source| {
        PublishedQuantity::new(name, &system, &values, band, (SourceKind::Memory, source))
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
        balance(all, "strength", &system),
    ]
}
