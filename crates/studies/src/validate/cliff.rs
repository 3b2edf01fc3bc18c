//! Validates columns of cohesive grains: with stronger cohesion they spread less, and a higher cliff stays standing.
//!
//! Consider a packing of discs of diameter d with the solid fraction φ, Z contacts per grain, and isotropic directions
//! of the contacts. Then φZ/(πd) contacts cross a unit of length. Each contact bears the cohesion force C₀, so the
//! tensile strength is σ_t = φ Z C₀/(π d). By Mohr and Coulomb the cohesion is c = σ_t tan φ_f with the friction angle
//! φ_f, and the height of a stable cliff is at most H = (4c/(ρ_b g)) tan(45° + φ_f/2) with the bulk density ρ_b and
//! gravity g. With C₀ = Bond·m g/2, the mass m = σπd²/4, the areal density σ and ρ_b = φσ, the solid fraction cancels:
//!
//! > H/d = ½ Z Bond tan φ_f tan(45° + φ_f/2).
//!
//! This height is an upper bound, because it assumes a slip along a plane. Other ways of failure may need a smaller
//! height.

use super::collapse::CollapsingColumn;
use super::experiment::*;
use super::fit::rank_correlation;
use super::variants::StepVariant;
use crate::scene::experiments::half_width;
use crate::statistics::mean;

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "cliff",
    title: "Cohesive columns",
    about: "The same columns with cohesion, H₀ = 2R₀ (A. Abramian, L. Staron, P.-Y. Lagrée, J. Rheol. 64, 1227, 2020; \
            A. Gans et al., J. Fluid Mech. 2023): run-out falls with Bond, and from some Bond on the cliff stands: its \
            centre of mass sinks by less than a fifth. The height that it then has is held against the bound of Mohr and Coulomb, \
            with tan φ_f = 0.36 and Z = 3.6. The surface of what has fallen is the rougher the more cohesive the \
            grains, and self-affine as a crack's (A. Abramian et al., Soft Matter 2021, D1SM01148K, whose abstract was \
            read): root mean square off a line through each 12 d of it.",
    cases: ExperimentCases::Chosen(cases),
    published: PUBLISHED,
    judge,
};

const ASPECT: f64 = 2.0;
const STANDS: f64 = 0.2;
/// Approximate tangent of the friction angle φ_f of discs with the friction coefficient μ = 0.5.
const TAN_OF_FRICTION: f64 = 0.36;
/// Approximate number Z of contacts per grain in the columns.
const COORDINATION: f64 = 3.6;

fn cases(effort: Effort, variant: StepVariant) -> Vec<ExperimentCase> {
    let (grains, seeds) = effort.pick((260, 3), (1_000, 8));
    let bonds: &[f64] = effort.pick(
        &[0.0, 10.0, 20.0, 40.0, 80.0, 160.0],
        &[0.0, 8.0, 16.0, 23.0, 32.0, 45.0, 64.0, 90.0, 128.0, 180.0],
    );
    seeded(bonds, seeds, |bond, seed| {
        let at = [("bond", bond), ("grains", f64::from(grains)), ("seed", seed as f64)];
        let column = CollapsingColumn { grains: grains as usize, aspect: ASPECT, seed, bond };
        let cost = f64::from(grains) * 6.0 / variant.time_step_secs;
        ExperimentCase::new(&at, cost, move || column.run(variant))
    })
}

/// Returns the largest possible height of a stable cliff by Mohr and Coulomb, in diameters, for the Bond number `bond`.
fn bound(bond: f64) -> f64 {
    let angle = TAN_OF_FRICTION.atan();
    let steepness = (0.25 * std::f64::consts::PI + 0.5 * angle).tan();
    0.5 * COORDINATION * bond * TAN_OF_FRICTION * steepness
}

/// Returns the Bond number above which columns made from the same seed remain standing. It is the geometric mean of two
/// neighbouring Bond numbers of the study: the smallest at which a column stands, and the next smaller one; NaN if
/// there is no such pair. At large Δt, columns with even stronger cohesion may fall again. This is a finding of
/// Abramian and Staron (2020) and not part of Mohr's theory.
fn standing_from(of_seed: &Measurements) -> f64 {
    let runs = &of_seed.0;
    let Some(first) = runs.iter().position(|case| case.reading("slump") < STANDS) else {
        return f64::NAN;
    };
    let before = first.checked_sub(1).map(|last| runs[last].at("bond"));
    let falls = before.filter(|bond| *bond > 0.0).unwrap_or(f64::NAN);
    (falls * runs[first].at("bond")).sqrt()
}

/// Table of published values as text, with one row for each quantity that the function [`judge`] computes from the
/// runs. A row has the form: name of the quantity | lower end of the band of values that agree, published value, upper
/// end of the band | kind of the source (`read`, `recalled`, `derived` or `exact`): source.
const PUBLISHED: &str = "
    rank correlation of run-out and Bond | -1 -1 -0.7 | recalled: Abramian et al. 2020, Gans et al. 2023: it falls
    rank correlation of roughness and Bond, of those that fall | 0.5 1 1 \
        | read: Abramian et al. 2021: it grows with cohesion
    exponent of roughness in length, the most cohesive that fall | 0.4 0.67 0.9 \
        | recalled: crack paths in the plane: 2/3
    height of the least cohesive cliff that stands, over the bound | 0.2 1 1 | recalled: Mohr, Coulomb: at most 1
";

fn judge(all: &Measurements) -> Vec<Measured> {
    let grains = all.first("grains");
    let system = format!("{grains} grains, Bond {}, {}", all.list("bond"), all.seeds());
    let trend = |runs: &Measurements, reading: &str| {
        runs.by_seed(|of_seed| {
            rank_correlation(&of_seed.rising(|case| (case.at("bond"), case.reading(reading))))
        })
    };
    let fallen = all.such_that(|case| case.reading("slump") >= STANDS);
    let exponents = fallen.by_seed(|of_seed| {
        let most = of_seed.values("bond").last().copied().unwrap_or(f64::NAN);
        of_seed.with("bond", most).reading("roughness_exponent")
    });
    let heights = all.by_seed(|mut of_seed| {
        of_seed.0.sort_by(|one, other| one.at("bond").total_cmp(&other.at("bond")));
        // The height of a column is a·R₀, with the aspect ratio a and the half width R₀, in diameters, which follows
        // from the number of grains.
        let height = mean(&of_seed.readings("aspect")).mean * half_width(grains as usize, ASPECT);
        height / bound(standing_from(&of_seed))
    });
    let values = [trend(all, "run_out"), trend(&fallen, "roughness"), exponents, heights];
    values.map(|values| (system.clone(), values)).into()
}
