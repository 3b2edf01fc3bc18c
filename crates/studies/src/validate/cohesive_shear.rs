//! Validates plane shear of cohesive grains: the effect of cohesion on the friction and the solid fraction of a sheared
//! layer, at one inertial number I (defined in `validate::shear`).
//!
//! Flows of grains of diameter d that attract each other with the force C₀, under the pressure P, have a second
//! dimensionless number in addition to I, the cohesion η = C₀/(P d). With C₀ = Bond·m g/2 for two grains of mass m
//! under gravity g, and P in units of m g/d, η = Bond/(2P).
//!
//! If the contact law defines the work W that breaks a bond, there is a third number, E = W/(m γ̇² d²) with the shear
//! rate γ̇. It is the ratio of this work to the kinetic energy with which grains pass each other. With the stepper
//! `range` the work is W = C₀ δ_c with the debonding distance δ_c, so E = η (δ_c/d)/I².

use super::experiment::*;
use super::fit::rank_correlation;
use super::shear::{LayerKind, PRESSURE, imbalances, layers};
use super::variants::StepVariant;
use crate::sim::Stepper;
use crate::statistics::mean;

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "cohesive-shear",
    title: "Cohesive plane shear",
    about: "The same at I ≈ 0.08 with cohesion, η = C₀/(P d): weak cohesion dilates and leaves friction as it is; from \
            some strength on friction rises, and the solid fraction falls further (P. Rognon et al., Europhys. Lett. \
            74, 644, 2006). That it is so was read, where weak ends and what number each has was not, so that signs and \
            rough sizes alone are tested. Under range and dem the energy of a bond is changed as well, E = W/(m γ̇² d²): \
            force and energy rule the viscosity of cohesive flows (M. Macaulay, P. Rognon, arXiv 2009.12050, 2020, \
            whose abstract was read). Methods that take no driven walls are left out.",
    cases: ExperimentCases::Chosen(cases),
    published: PUBLISHED,
    judge,
};

pub(super) const INERTIAL: f64 = 0.08;
/// Dimensionless cohesion η = C₀/(P d) that represents weak cohesion. C₀ is the cohesion force, P the pressure on the
/// layer and d the diameter of a grain.
pub(super) const WEAK: f64 = 1.0;
/// Dimensionless cohesion η = C₀/(P d) that represents strong cohesion, with cohesion force C₀, pressure P on the layer
/// and grain diameter d.
const STRONG: f64 = 30.0;

/// Dimensionless cohesion η = C₀/(P d) of those layers for which the work to break a bond is prescribed. C₀ is the
/// cohesion force, P the pressure and d the diameter of a grain.
const FORCES: [f64; 2] = [3.0, 10.0];
/// Dimensionless bond energies E = W/(m γ̇² d²) of those layers for which the work W to break a bond is prescribed. γ̇
/// is the shear rate, and m and d are mass and diameter of a grain. Time steps of 1 ms resolve the breaking of the
/// weakest of these bonds.
const ENERGIES: [f64; 4] = [1.0, 3.0, 10.0, 30.0];

fn cases(effort: Effort, variant: StepVariant) -> Vec<ExperimentCase> {
    let strengths: &[f64] =
        effort.pick(&[0.0, WEAK, STRONG], &[0.0, 0.3, WEAK, 3.0, 10.0, STRONG, 60.0]);
    let layer = |strength: f64, breaking_energy: Option<f64>| LayerKind {
        at: vec![("strength", strength), ("energy", breaking_energy.unwrap_or(0.0))],
        inertial: INERTIAL,
        bond: 2.0 * PRESSURE * strength,
        breaking_energy,
        bounds: None,
    };
    let mut kinds: Vec<LayerKind> =
        strengths.iter().map(|&strength| layer(strength, None)).collect();
    if matches!(variant.stepper, Stepper::Range | Stepper::Dem) {
        let of_force = |force| ENERGIES.map(|energy| layer(force, Some(energy)));
        kinds.extend(FORCES.into_iter().flat_map(of_force));
    }
    layers(effort, variant, &kinds)
}

/// Table of published values as text, with one row for each quantity that the function [`judge`] computes from the
/// runs. A row has the form: name of the quantity | lower end of the band of values that agree, published value, upper
/// end of the band | kind of the source (`read`, `recalled`, `derived` or `exact`): source.
const PUBLISHED: &str = "
    T/N at η = 1 over that without cohesion | 0.85 1 1.2 | recalled: Rognon et al. 2006: weak cohesion leaves it
    φ at η = 1 less that without cohesion | -0.04 -0.01 0 | recalled: Rognon et al. 2006: weak cohesion dilates
    T/N at η = 30 over that without cohesion | 1.2 2 inf | recalled: Rognon et al. 2006: strong cohesion raises it
    φ at η = 30 less that without cohesion | -inf -0.1 -0.02 \
        | recalled: Rognon et al. 2006: strong cohesion dilates further
    T of the plates: their difference over their sum | -0.05 0 0.05 | exact: a steady flow gains no momentum
    rank correlation of T/N and the energy of a bond, η = 3 | 0.5 1 1 \
        | read: Macaulay, Rognon 2020: energy and force of a bond rule the viscosity
    rank correlation of T/N and the energy of a bond, η = 10 | 0.5 1 1 \
        | read: Macaulay, Rognon 2020: energy and force of a bond rule the viscosity
    T/N at η = 10 over that at η = 3, same energies | 1.02 1.3 inf \
        | read: Macaulay, Rognon 2020: energy and force of a bond rule the viscosity
";

fn judge(measured: &Measurements) -> Vec<Measured> {
    let all = &measured.with("energy", 0.0);
    let (grains, strengths) = (all.first("grains"), all.list("strength"));
    let system = format!("{grains} grains, η = {strengths}, {}", all.seeds());
    // Each layer is compared with the layer of the same seed without cohesion.
    let against = |strength: f64, reading: &str, of: fn(f64, f64) -> f64| {
        all.by_seed(|of_seed| {
            let at = |strength| of_seed.with("strength", strength).reading(reading);
            of(at(strength), at(0.0))
        })
    };
    let (ratio, difference) = (|with, without| with / without, |with, without| with - without);
    let values = [
        against(WEAK, "friction", ratio),
        against(WEAK, "solid_fraction", difference),
        against(STRONG, "friction", ratio),
        against(STRONG, "solid_fraction", difference),
        imbalances(all, "strength"),
    ];
    let mut quantities = values.map(|values| (system.clone(), values)).to_vec();
    quantities.extend(of_energies(&measured.such_that(|case| case.at("energy") > 0.0)));
    quantities
}

/// Measures how the friction of sheared layers depends on the bonds. Returns three quantities with one value per seed:
/// the rank correlations of friction and bond energy at the two cohesion forces, and the mean friction at the larger
/// force divided by that at the smaller force.
fn of_energies(all: &Measurements) -> Vec<Measured> {
    if all.0.is_empty() {
        return Vec::new();
    }
    let system =
        format!("{} grains, E = {}, {}", all.first("grains"), all.list("energy"), all.seeds());
    let [weak, strong] = FORCES.map(|force| {
        all.with("strength", force).by_seed(|of_seed| {
            rank_correlation(&of_seed.points(|case| (case.at("energy"), case.reading("friction"))))
        })
    });
    let ratios = all.by_seed(|of_seed| {
        let [weak, strong] =
            FORCES.map(|force| mean(&of_seed.with("strength", force).readings("friction")).mean);
        strong / weak
    });
    [weak, strong, ratios].map(|values| (system.clone(), values)).into()
}
