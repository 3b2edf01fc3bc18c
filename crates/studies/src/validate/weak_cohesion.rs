//! Validates the friction of a sheared layer of grains with weak cohesion, η = C₀/(P d) = 1, for both friction cones
//! and different touch tolerances (gaps up to which contacts pull). C₀ is the cohesion force, P the pressure and d the
//! diameter.
//!
//! `validate::cohesive_shear` finds more friction at η = 1 than without cohesion. Three causes are possible. First, the
//! shifted cone bounds friction by μ(N + C₀) with the friction coefficient μ and the normal force N (the compressive
//! cone by μ max(N, 0)), so that sliding contacts bear up to μC₀ more. Second, at touch tolerance 0 cohesion acts
//! on an opening contact within one step only, so its effect depends on Δt. Third, with a larger touch tolerance, contacts that are slightly
//! open pull, and in the shifted cone they also bear friction.

use super::cohesive_shear::{INERTIAL, WEAK};
use super::experiment::*;
use super::shear::{LayerKind, PRESSURE, layers};
use super::variants::StepVariant;
use crate::sim::Stepper;
use crate::world::FrictionCone;

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "weak-cohesion",
    title: "Plane shear with weak cohesion",
    about: "The layers of cohesive plane shear at η = 1, with either cone and with touch tolerances of 0 and 0.01 d, \
            against the same layers without cohesion. P. Rognon et al., Europhys. Lett. 74, 644 (2006), see no \
            difference. Run with several time steps. Only under moreau.",
    cases: ExperimentCases::Chosen(cases),
    published: PUBLISHED,
    judge,
};

/// Compared friction cones (bounds of friction by the normal force with or without the cohesion force), each with a
/// touch tolerance (the gap up to which contacts pull) in diameters d.
const BOUNDS: [(FrictionCone, f64); 4] = [
    (FrictionCone::Shifted, 0.0),
    (FrictionCone::Compressive, 0.0),
    (FrictionCone::Shifted, 0.01),
    (FrictionCone::Compressive, 0.01),
];

fn cases(effort: Effort, variant: StepVariant) -> Vec<ExperimentCase> {
    if variant.stepper != Stepper::Moreau {
        return Vec::new();
    }
    let layer = |number: f64, strength: f64, bounds: (FrictionCone, f64)| LayerKind {
        at: vec![("bounds", number)],
        inertial: INERTIAL,
        bond: 2.0 * PRESSURE * strength,
        breaking_energy: None,
        bounds: Some(bounds),
    };
    let mut kinds = vec![layer(0.0, 0.0, BOUNDS[0])];
    kinds.extend((1..).zip(BOUNDS).map(|(number, bounds)| layer(f64::from(number), WEAK, bounds)));
    layers(effort, variant, &kinds)
}

/// Table of published values as text, with one row for each quantity that the function [`judge`] computes from the
/// runs. A row has the form: name of the quantity | lower end of the band of values that agree, published value, upper
/// end of the band | kind of the source (`read`, `recalled`, `derived` or `exact`): source. The rows are in the order
/// of [`BOUNDS`].
const PUBLISHED: &str = "
    T/N over that without cohesion, shifted cone, tolerance 0 \
        | 0.85 1 1.2 | recalled: Rognon et al. 2006: weak cohesion leaves it
    T/N over that without cohesion, compressive cone, tolerance 0 \
        | 0.85 1 1.2 | recalled: Rognon et al. 2006: weak cohesion leaves it
    T/N over that without cohesion, shifted cone, tolerance 0.01 d \
        | 0.85 1 1.2 | recalled: Rognon et al. 2006: weak cohesion leaves it
    T/N over that without cohesion, compressive cone, tolerance 0.01 d \
        | 0.85 1 1.2 | recalled: Rognon et al. 2006: weak cohesion leaves it
";

fn judge(all: &Measurements) -> Vec<Measured> {
    let system = format!("{} grains, η = {WEAK}, {}", all.first("grains"), all.seeds());
    // Each layer is compared with the layer of the same seed without cohesion.
    let ratios = |number: f64| {
        all.by_seed(|of_seed| {
            let friction = |number| of_seed.with("bounds", number).reading("friction");
            friction(number) / friction(0.0)
        })
    };
    [1.0, 2.0, 3.0, 4.0].map(|number| (system.clone(), ratios(number))).into()
}
