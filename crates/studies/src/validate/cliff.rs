//! Columns of cohesive grains: the more cohesive, the less they spread, and how high a cliff they hold.
//!
//! A packing with Z contacts a grain and branches in all directions alike has φZ/(πd) contacts across a unit of length,
//! each of which bears C₀, so that its tensile strength is σ_t = φ Z C₀/(π d). By Mohr and Coulomb it has the cohesion
//! c = σ_t tan φ_f, and a cliff stands no higher than H = (4c/(ρ_b g)) tan(45° + φ_f/2). With C₀ = Bond·m g/2, m = σπd²/4
//! and ρ_b = φσ the solid fraction drops out:
//!
//! > H/d = ½ Z Bond tan φ_f tan(45° + φ_f/2).
//!
//! It bounds H from above: a slip along a plane is one way to fall, and there may be easier ones.

use super::experiment::{Case, Cases, Experiment, Found, values, with};
use super::quantity::{Provenance, Quantity};
use super::spread::Column;
use super::way::Way;
use crate::statistics::mean;

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "cliff",
    title: "Cohesive columns",
    about: "The same columns with cohesion, H₀ = 2R₀ (A. Abramian, L. Staron, P.-Y. Lagrée, J. Rheol. 64, 1227, 2020; \
            A. Gans et al., J. Fluid Mech. 2023): run-out falls with Bond, and from some Bond on the cliff stands: its \
            centre of mass sinks by less than a fifth. The height that it then has is held against the bound of Mohr and Coulomb, \
            with tan φ_f = 0.36 and Z = 3.6.",
    cases: Cases::Chosen(cases),
    judge,
};

/// H₀/R₀.
const ASPECT: f64 = 2.0;
/// Slump below which a cliff stands.
const STANDS: f64 = 0.2;
/// tan φ_f of discs with μ = 0.5, about.
const TAN_OF_FRICTION: f64 = 0.36;
/// Z of the columns, about.
const COORDINATION: f64 = 3.6;

fn cases(quick: bool, way: Way) -> Vec<Case> {
    let (grains, seeds) = if quick { (260, 3u32) } else { (1_000, 8) };
    let bonds: &[f64] = if quick {
        &[0.0, 10.0, 20.0, 40.0, 80.0, 160.0]
    } else {
        &[0.0, 8.0, 16.0, 23.0, 32.0, 45.0, 64.0, 90.0, 128.0, 180.0]
    };
    let mut cases = Vec::new();
    for &bond in bonds {
        for seed in 1..=seeds {
            let at = vec![("bond", bond), ("grains", f64::from(grains)), ("seed", f64::from(seed))];
            let column =
                Column { grains: grains as usize, aspect: ASPECT, seed: u64::from(seed), bond };
            let cost = f64::from(grains) * 6.0 / way.time_step_secs;
            cases.push(Case { at, cost, run: Box::new(move || column.run(way)) });
        }
    }
    cases
}

/// The highest cliff by Mohr and Coulomb, in d.
fn bound(bond: f64) -> f64 {
    let angle = TAN_OF_FRICTION.atan();
    let steepness = (0.25 * std::f64::consts::PI + 0.5 * angle).tan();
    0.5 * COORDINATION * bond * TAN_OF_FRICTION * steepness
}

/// The Bond from which on the columns of a seed stand, between the last that falls and the first that does not, in
/// ratio; NaN where none falls before or none stands. Still more cohesive ones may fall again where Δt is large: that
/// is the paper's finding, and none of Mohr's.
fn standing_from(runs: &[&Found]) -> f64 {
    let Some(first) = runs.iter().position(|one| one.reading("slump") < STANDS) else {
        return f64::NAN;
    };
    let before = first.checked_sub(1).map(|last| runs[last].at("bond"));
    let falls = before.filter(|bond| *bond > 0.0).unwrap_or(f64::NAN);
    (falls * runs[first].at("bond")).sqrt()
}

/// Correlation of the ranks of two columns (C. Spearman 1904), without ties.
pub(super) fn rank_correlation(pairs: &[(f64, f64)]) -> f64 {
    let rank = |of: fn(&(f64, f64)) -> f64, value: f64| {
        pairs.iter().filter(|pair| of(pair) < value).count() as f64
    };
    let count = pairs.len() as f64;
    let squares: f64 = pairs
        .iter()
        .map(|pair| (rank(|pair| pair.0, pair.0) - rank(|pair| pair.1, pair.1)).powi(2))
        .sum();
    1.0 - 6.0 * squares / (count * (count * count - 1.0))
}

fn judge(found: &[Found]) -> Vec<Quantity> {
    let grains = found.first().map_or(0.0, |one| one.at("grains"));
    let (bonds, seeds) = (values(found, "bond"), values(found, "seed"));
    let list: Vec<String> = bonds.iter().map(f64::to_string).collect();
    let system = format!("{grains} grains, Bond {}, {} seeds", list.join(", "), seeds.len());
    let (mut trends, mut ratios) = (Vec::new(), Vec::new());
    for seed in seeds {
        let mut runs: Vec<&Found> = with(found, "seed", seed).collect();
        runs.sort_by(|one, other| one.at("bond").total_cmp(&other.at("bond")));
        let pairs: Vec<(f64, f64)> =
            runs.iter().map(|one| (one.at("bond"), one.reading("run_out"))).collect();
        trends.push(rank_correlation(&pairs));
        // H₀ = a R₀, R₀ in d from the number of grains.
        let height = mean(&runs.iter().map(|one| one.reading("aspect")).collect::<Vec<_>>()).mean
            * crate::scene::experiments::half_width(grains as usize, ASPECT);
        ratios.push(height / bound(standing_from(&runs)));
    }
    let quantity = |name: &str, values: &[f64], band, source| {
        Quantity::new(name, &system, mean(values), band, (Provenance::Memory, source))
    };
    vec![
        quantity(
            "rank correlation of run-out and Bond",
            &trends,
            [f64::NEG_INFINITY, -1.0, -0.7],
            "Abramian et al. 2020, Gans et al. 2023: it falls",
        ),
        quantity(
            "height of the least cohesive cliff that stands, over the bound",
            &ratios,
            [0.2, 1.0, 1.0],
            "Mohr, Coulomb: at most 1",
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_correlate_as_tables_say() {
        assert_eq!(rank_correlation(&[(1.0, 9.0), (2.0, 7.0), (5.0, 1.0)]), -1.0);
        assert_eq!(rank_correlation(&[(1.0, 1.0), (2.0, 7.0), (5.0, 9.0)]), 1.0);
        assert_eq!(rank_correlation(&[(1.0, 2.0), (2.0, 1.0), (3.0, 3.0)]), 0.5);
    }
}
