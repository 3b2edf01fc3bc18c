//! Slumps of piles that start from the same states and are stepped by two laws or variants of the solver, at the same Bond and
//! Δt.

use std::collections::BTreeMap;

use super::claims::{Claim, SIGNIFICANT, Verdict};
use super::studies::Rows;
use crate::RunResult;
use crate::chart::Point;
use crate::config::Config;
use crate::statistics::{Mean, mean, p_value};

/// A difference of slump up to which one variant stands for the other, by the largest number of grains that it is
/// asked of. Slumps are 0.05 to 0.5, and those of two states of a size differ by 0.1 and more.
const MARGINS: [(usize, f64); 2] = [(138, 0.02), (usize::MAX, 0.04)];

/// The margin for piles of so many grains.
pub(super) fn margin(grains: usize) -> f64 {
    MARGINS.iter().find(|(most, _)| grains <= *most).map_or(0.0, |(_, margin)| *margin)
}

/// The slumps of all states that ended in both variants, at one Bond and Δt.
pub(super) struct PairedSlumps {
    /// Names it in a sentence.
    pub name: String,
    pub bond: f64,
    /// Δt, s.
    pub step: f64,
    pub reference: Mean,
    pub other: Mean,
    /// The other's less the reference's, state by state.
    pub difference: Mean,
    /// That of each state, by its seed.
    of_states: Vec<(Option<u64>, f64)>,
}

impl PairedSlumps {
    pub(super) fn new(
        name: String,
        (bond, step): (f64, f64),
        reference: &Rows<'_>,
        other: &Rows<'_>,
    ) -> Self {
        let pairs = pairs(reference, other);
        let of_states: Vec<_> = pairs.iter().map(|(seed, one, two)| (*seed, two - one)).collect();
        Self {
            name,
            bond,
            step,
            reference: mean(&pairs.iter().map(|(_, one, _)| *one).collect::<Vec<_>>()),
            other: mean(&pairs.iter().map(|(_, _, two)| *two).collect::<Vec<_>>()),
            difference: mean(&of_states.iter().map(|(_, apart)| *apart).collect::<Vec<_>>()),
            of_states,
        }
    }

    /// Named for its Bond and Δt.
    pub(super) fn at(bond: f64, step: f64, reference: &Rows<'_>, other: &Rows<'_>) -> Self {
        Self::new(format!("Bond {bond} at {step:e} s"), (bond, step), reference, other)
    }

    /// Every Δt of the other with every Bond of it.
    pub(super) fn all(reference: &Rows<'_>, other: &Rows<'_>) -> Vec<Self> {
        let bonds = other.bonds();
        let at = |bond: f64, step: f64| {
            let [reference, other] =
                [reference, other].map(|rows| rows.of_bond(bond).of_step(step));
            Self::at(bond, step, &reference, &other)
        };
        let places =
            other.steps().into_iter().flat_map(|step| bonds.iter().map(move |&b| (b, step)));
        places.map(|(bond, step)| at(bond, step)).collect()
    }

    /// How far its 95 % interval goes from 0.
    fn reach(&self) -> f64 {
        self.difference.low.abs().max(self.difference.high.abs())
    }

    /// Whether its 95 % interval is without 0.
    pub(super) fn differs(&self) -> bool {
        self.difference.low > 0.0 || self.difference.high < 0.0
    }

    /// The difference on a chart.
    pub(super) fn point(&self, x: f64) -> Point {
        let Mean { mean, low, high, count, .. } = self.difference;
        // Two states tell next to nothing of their spread.
        Point { x, y: mean, interval: (count > 2).then_some((low, high)) }
    }

    /// Its numbers in a table, under the last of [`columns`].
    pub(super) fn cells(&self) -> impl Iterator<Item = String> {
        let Mean { mean, standard_error, low, high, count, .. } = self.difference;
        let p = self.difference.p_not_zero();
        let numbers = [self.reference.mean, mean, standard_error, low, high, p];
        std::iter::once(count.to_string()).chain(numbers.map(|value| format!("{value:.4}")))
    }
}

/// The states that ended in both: seed, slump of the reference, that of the other.
pub(super) fn pairs(reference: &Rows<'_>, other: &Rows<'_>) -> Vec<(Option<u64>, f64, f64)> {
    let with = |seed| other.0.iter().find(move |(config, _)| config.source.seed == seed);
    let pair = |(config, result): &(&Config, &RunResult)| {
        let seed = config.source.seed;
        Some((seed, result.slump, with(seed)?.1.slump))
    };
    reference.0.iter().filter_map(pair).collect()
}

/// The columns of a table of comparisons with `reference` after columns of its own.
pub(super) fn columns(own: &[&'static str], reference: &'static str) -> Vec<&'static str> {
    [own, &["states", reference, "difference", "standard_error", "low", "high", "p"]].concat()
}

/// How far any of the intervals goes from 0, of those that end; 0.05 at least.
pub(super) fn widest(all: &[PairedSlumps]) -> f64 {
    all.iter().map(PairedSlumps::reach).filter(|reach| reach.is_finite()).fold(0.05, f64::max)
}

/// That piles of so many grains slump alike `how`.
pub(super) fn claim_of_size(grains: usize, how: &str, all: &[PairedSlumps]) -> Claim {
    let margin = margin(grains);
    let said = format!(
        "Beyond the paper: {grains} grains slump {how}, within {margin} at every Bond and Δt"
    );
    claim(said, all, margin)
}

/// What is said of differences that are to be within a margin everywhere. With many comparisons some differ by
/// chance, so p-values are multiplied by their number (Bonferroni).
pub(super) fn claim(said: String, all: &[PairedSlumps], margin: f64) -> Claim {
    let outside: Vec<_> = all
        .iter()
        .filter(|one| one.differs())
        .map(|one| format!("{} ({:+.3})", one.name, one.difference.mean))
        .collect();
    // A value a state: its mean difference over all of them.
    let mut of_states: BTreeMap<Option<u64>, Vec<f64>> = BTreeMap::new();
    for (seed, difference) in all.iter().flat_map(|one| &one.of_states) {
        of_states.entry(*seed).or_default().push(*difference);
    }
    let of_states: Vec<_> = of_states.values().map(|some| mean(some).mean).collect();
    let pooled = mean(&of_states);
    let count = all.len();
    let least = all.iter().map(|one| one.difference.p_not_zero()).fold(1.0, f64::min);
    let p = (least * count as f64).min(1.0);
    let by_chance = 100.0 * (1.0 - 0.95f64.powi(count as i32));
    let farthest = all.iter().map(PairedSlumps::reach).fold(0.0, f64::max);
    let measured = format!(
        "{} of {count} differences have a 95 % interval without 0{}{}, where without any effect at least one has \
         in {by_chance:.0} % of such studies; any difference: {}; mean over all {:+.4} ± {:.4}; the intervals \
         reach to ±{farthest:.3}; {} states",
        outside.len(),
        if outside.is_empty() { "" } else { ": " },
        outside.join(", "),
        p_value(p),
        pooled.mean,
        pooled.standard_error,
        of_states.len(),
    );
    let verdict = match (p < SIGNIFICANT, farthest <= margin) {
        (true, _) => Verdict::Fails,
        (false, true) => Verdict::Holds,
        (false, false) => Verdict::Open,
    };
    Claim::new(said, measured.replace('-', "−"), verdict)
}
