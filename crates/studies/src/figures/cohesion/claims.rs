//! What is said of slump and the work of fracture.

use std::collections::BTreeMap;

use super::super::paired::{Place, claim, columns, pairs};
use super::super::table::Table;
use super::super::verdict::{Claim, Verdict};
use super::levels::Level;
use crate::statistics::mean;

/// A difference of slump up to which one law stands for the other, as in other figures of 138 grains.
const MARGIN: f64 = 0.02;

/// That both laws let piles slump alike at equal Bond and work.
pub(super) fn laws_agree(levels: &[Level<'_>]) -> Claim {
    let place = |level: &Level<'_>| Place {
        name: format!("Bond {} at {:.0e} m g d", level.bond, level.works[0]),
        at: (level.bond, 0.0),
        pairs: pairs(&level.runs.reference, &level.runs.other),
    };
    let said = format!(
        "Beyond the paper: at equal Bond and work of fracture piles slump under dem as under range, within {MARGIN}"
    );
    claim(said, &levels.iter().map(place).collect::<Vec<_>>(), MARGIN)
}

/// That slump hangs on the work alone, and not on Bond besides: the largest against the smallest, under `range`.
pub(super) fn bonds_agree(bonds: &[f64], levels: &[Level<'_>]) -> Claim {
    let (least, most) = (bonds[0], bonds[bonds.len() - 1]);
    let of = |bond: f64| levels.iter().filter(move |level| level.bond == bond);
    let place = |(one, other): (&Level<'_>, &Level<'_>)| Place {
        name: format!("Bond {most} less {least} at {:.0e} m g d", one.works[0]),
        at: (most, 0.0),
        pairs: pairs(&one.runs.reference, &other.runs.reference),
    };
    let said = format!(
        "Beyond the paper: under range piles of the same work of fracture slump alike whatever the Bond, within {MARGIN}"
    );
    claim(said, &of(least).zip(of(most)).map(place).collect::<Vec<_>>(), MARGIN)
}

/// By which factor the work of `dem` would have to be another for its curve to lie on that of `range`: the shift
/// along the logarithm of W, by least squares over the levels, a value a state.
pub(super) fn factor(bonds: &[f64], levels: &[Level<'_>]) -> Claim {
    let mut of_states: BTreeMap<Option<u64>, [f64; 2]> = BTreeMap::new();
    for &bond in bonds {
        let here: Vec<_> = levels.iter().filter(|level| level.bond == bond).collect();
        let mean_of = |level: &&Level<'_>| (level.works[0].ln(), mean(&level.slumps(0)).mean);
        let curve: Vec<_> = here.iter().map(mean_of).collect();
        for (index, level) in here.iter().enumerate() {
            let (before, after) = (index.saturating_sub(1), (index + 1).min(here.len() - 1));
            let run = curve[after].0 - curve[before].0;
            if run <= 0.0 {
                continue;
            }
            let slope = (curve[after].1 - curve[before].1) / run;
            // The works of the two are not quite the same.
            let apart = slope * (level.works[1] / level.works[0]).ln();
            for (seed, of_range, of_dem) in pairs(&level.runs.reference, &level.runs.other) {
                let [product, square] = of_states.entry(seed).or_default();
                *product += slope * (of_dem - of_range - apart);
                *square += slope * slope;
            }
        }
    }
    let shifts: Vec<f64> = of_states.values().map(|[product, square]| product / square).collect();
    let [told, low, high] = {
        let shift = mean(&shifts);
        [shift.mean, shift.low, shift.high].map(f64::exp)
    };
    let measured = format!(
        "the work of dem counts as {told:.2} times that of range (95 % interval {low:.2} … {high:.2}, {} states; \
         without any effect 5 % of such intervals do not hold 1); 2 would be that of bonds torn faster than their \
         dashpots let springs push",
        shifts.len()
    );
    let said = "Beyond the paper: what counts of dem's work of fracture is that of a slow break";
    Claim::new(said, measured, Verdict::of_interval(1.0, low, high))
}

/// The numbers behind the claims.
pub(super) fn table(levels: &[Level<'_>]) -> Table {
    let columns = columns(&["bond", "work_range", "work_dem"], "slump_range");
    let mut rows = Vec::new();
    for level in levels {
        for one in level.runs.comparisons() {
            let works = level.works.map(|work| format!("{work:.2e}"));
            let mut row = vec![level.bond.to_string()];
            row.extend(works);
            row.extend(one.cells());
            rows.push(row);
        }
    }
    Table { name: "cohesion-differences", columns, rows }
}

#[cfg(test)]
mod tests {
    use super::super::super::workshop::Rows;
    use super::super::levels::levels;
    use super::*;
    use crate::Outcome;
    use crate::config::Config;
    use crate::sim::Stepper;

    /// Slumps that fall with the logarithm of the work, under `dem` as if it were `factor` times as much, and by
    /// `of_bond` more at the larger Bond.
    fn runs(factor: f64, of_bond: f64) -> Vec<(Config, Outcome)> {
        let mut runs = Vec::new();
        for (bond, more) in [(10.0, 0.0), (20.0, of_bond)] {
            for work in [1e-3, 1e-2, 1e-1f64] {
                for seed in 1..=16u64 {
                    let scatter = 4e-3 * (seed as f64 * 1.7 + bond + work.ln()).sin();
                    for law in [Stepper::Range, Stepper::Dem] {
                        let is_dem = law == Stepper::Dem;
                        let counted = if is_dem { factor * work } else { work };
                        let moved = if is_dem { scatter } else { -more };
                        let moved = if is_dem { moved - more } else { moved };
                        let slump = 0.01 * seed as f64 - 0.1 * counted.log10() + moved;
                        let mut config = Config::of_scene("pile");
                        config.stepper = Some(law);
                        config.source.seed = Some(seed);
                        config.parameters.bond = Some(bond);
                        config.parameters.time_step_secs = Some(1e-4);
                        config.parameters.debonding_distance =
                            Some(if is_dem { 0.01 } else { 2.0 * work / bond });
                        // W = Bond² m g/(8 k d) in m g d, with the shipped state's mean mass.
                        let stiffness =
                            bond * bond * 1.97996507577608e-5 * 9.8 / (8.0 * 5e-3 * work);
                        config.parameters.stiffness = Some(if is_dem { stiffness } else { 0.0 });
                        runs.push((config, Outcome::of_slump(slump)));
                    }
                }
            }
        }
        runs
    }

    fn claims(shift: f64, of_bond: f64) -> [Claim; 3] {
        let runs = runs(shift, of_bond);
        let rows = Rows(runs.iter().map(|(config, outcome)| (config, outcome)).collect());
        let levels = levels(&rows).expect("levels");
        assert_eq!(levels.len(), 6);
        for (level, work) in levels.iter().zip([1e-3, 1e-2, 1e-1, 1e-3, 1e-2, 1e-1]) {
            let off = level.works.map(|found| (found / work - 1.0).abs());
            assert!(off.iter().all(|off| *off < 1e-9), "{work}: {:?}", level.works);
        }
        assert!(table(&levels).rows.iter().all(|row| row.len() == 10 && row[3] == "16"));
        let bonds = [10.0, 20.0];
        [laws_agree(&levels), factor(&bonds, &levels), bonds_agree(&bonds, &levels)]
    }

    #[test]
    fn laws_that_agree_are_told_from_those_that_do_not_and_by_which_factor() {
        let [laws, factor, bonds] = claims(1.0, 0.0);
        assert_eq!(laws.verdict, Verdict::Holds, "{}", laws.measured);
        assert_eq!(factor.verdict, Verdict::Holds, "{}", factor.measured);
        assert_eq!(bonds.verdict, Verdict::Holds, "{}", bonds.measured);
        let [laws, factor, bonds] = claims(2.0, 0.1);
        assert_eq!(laws.verdict, Verdict::Fails, "{}", laws.measured);
        assert_eq!(factor.verdict, Verdict::Fails, "{}", factor.measured);
        assert!(factor.measured.contains("as 2.0") || factor.measured.contains("as 1.9"));
        assert_eq!(bonds.verdict, Verdict::Fails, "{}", bonds.measured);
        assert!(bonds.measured.contains("(−0.100)"), "{}", bonds.measured);
    }
}
