//! Slumps of piles that start from the same states and are solved in two ways, at the same Bond and Δt.

use std::collections::BTreeMap;

use super::verdict::{Claim, SIGNIFICANT, Verdict};
use super::workshop::Rows;
use crate::Outcome;
use crate::chart::Point;
use crate::config::Config;
use crate::statistics::{Mean, mean, p_value};

/// A difference of slump up to which one way stands for the other, by the largest number of grains that it is
/// asked of. Slumps are 0.05 to 0.5, and those of two states of a size differ by 0.1 and more.
const MARGINS: [(usize, f64); 2] = [(138, 0.02), (usize::MAX, 0.04)];

/// A Bond and a Δt at one number of grains.
pub(super) struct Comparison {
    pub bond: f64,
    /// Δt, s.
    pub step: f64,
    /// Of the reference.
    pub slump: Mean,
    /// The other way's less the reference's, state by state.
    pub difference: Mean,
}

impl Comparison {
    fn of((bond, step): (f64, f64), pairs: &[(Option<u64>, f64, f64)]) -> Self {
        let slumps: Vec<f64> = pairs.iter().map(|(_, reference, _)| *reference).collect();
        let differences: Vec<f64> = pairs.iter().map(|(_, one, other)| other - one).collect();
        Self { bond, step, slump: mean(&slumps), difference: mean(&differences) }
    }

    /// p-value of no difference.
    fn p(&self) -> f64 {
        (2.0 * self.difference.p_above(0.0).min(self.difference.p_below(0.0))).min(1.0)
    }

    /// How far its 95 % interval goes from 0.
    fn reach(&self) -> f64 {
        self.difference.low.abs().max(self.difference.high.abs())
    }

    fn differs(&self) -> bool {
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
        let numbers = [self.slump.mean, mean, standard_error, low, high, self.p()];
        let written = numbers.map(|value| format!("{value:.4}"));
        std::iter::once(count.to_string()).chain(written)
    }
}

/// The columns of a table that tells of comparisons with `reference` after columns of its own.
pub(super) fn columns(own: &[&'static str], reference: &'static str) -> Vec<&'static str> {
    let told = ["states", reference, "difference", "standard_error", "low", "high", "p"];
    [own, &told].concat()
}

/// How far any of the intervals goes from 0, of those that end; 0.05 at least.
pub(super) fn widest(all: &[Comparison]) -> f64 {
    all.iter().map(Comparison::reach).filter(|reach| reach.is_finite()).fold(0.05, f64::max)
}

/// Runs of one number of grains, solved in two ways.
pub(super) struct Paired<'a> {
    pub grains: usize,
    pub reference: Rows<'a>,
    pub other: Rows<'a>,
}

impl Paired<'_> {
    /// The states that ended in both ways: seed, slump of the reference, that of the other.
    fn pairs(&self, bond: f64, step: f64) -> Vec<(Option<u64>, f64, f64)> {
        let at = |config: &Config| {
            let Config { parameters, .. } = config;
            parameters.bond == Some(bond) && parameters.time_step_secs == Some(step)
        };
        pairs(&self.reference.such_that(at), &self.other.such_that(at))
    }

    /// Every Δt with every Bond.
    fn places(&self) -> Vec<(f64, f64)> {
        let bonds = self.other.values(|config| config.parameters.bond);
        let steps = self.other.values(|config| config.parameters.time_step_secs);
        steps.iter().flat_map(|&step| bonds.iter().map(move |&bond| (bond, step))).collect()
    }

    /// Every Bond at every Δt.
    pub(super) fn comparisons(&self) -> Vec<Comparison> {
        let compared = |(bond, step)| Comparison::of((bond, step), &self.pairs(bond, step));
        self.places().into_iter().map(compared).collect()
    }

    fn margin(&self) -> f64 {
        let found = MARGINS.iter().find(|(grains, _)| self.grains <= *grains);
        found.map_or(0.0, |(_, margin)| *margin)
    }

    /// That piles slump alike `how`, and whether they do.
    pub(super) fn claim(&self, how: &str) -> Claim {
        let said = format!(
            "Beyond the paper: {} grains slump {how}, within {} at every Bond and Δt",
            self.grains,
            self.margin()
        );
        let named = |(bond, step)| Place {
            name: format!("Bond {bond} at {step:e} s"),
            at: (bond, step),
            pairs: self.pairs(bond, step),
        };
        claim(said, &self.places().into_iter().map(named).collect::<Vec<_>>(), self.margin())
    }
}

/// States that were stepped in two ways: seed, slump of the reference, that of the other.
type Pairs = Vec<(Option<u64>, f64, f64)>;

/// The states that ended in both ways.
pub(super) fn pairs(reference: &Rows<'_>, other: &Rows<'_>) -> Pairs {
    let with = |seed| other.0.iter().find(move |(config, _)| config.source.seed == seed);
    let pair = |(config, outcome): &(&Config, &Outcome)| {
        let seed = config.source.seed;
        Some((seed, outcome.slump, with(seed)?.1.slump))
    };
    reference.0.iter().filter_map(pair).collect()
}

/// Where two ways are compared.
pub(super) struct Place {
    /// In a sentence.
    pub name: String,
    /// Bond and Δt (s).
    pub at: (f64, f64),
    pub pairs: Pairs,
}

impl Place {
    /// What its pairs say.
    pub(super) fn comparison(&self) -> Comparison {
        Comparison::of(self.at, &self.pairs)
    }
}

/// What is said of differences that are to be within a margin everywhere. With many comparisons some differ by
/// chance, so p-values are multiplied by their number (Bonferroni).
pub(super) fn claim(said: String, places: &[Place], margin: f64) -> Claim {
    let all: Vec<_> = places.iter().map(Place::comparison).collect();
    let outside: Vec<_> = places
        .iter()
        .zip(&all)
        .filter(|(_, one)| one.differs())
        .map(|(place, one)| format!("{} ({:+.3})", place.name, one.difference.mean))
        .collect();
    // A value a state: its mean difference over all places.
    let mut of_states: BTreeMap<Option<u64>, Vec<f64>> = BTreeMap::new();
    for (seed, one, other) in places.iter().flat_map(|place| &place.pairs) {
        of_states.entry(*seed).or_default().push(other - one);
    }
    let of_states: Vec<_> = of_states.values().map(|some| mean(some).mean).collect();
    let pooled = mean(&of_states);
    let count = all.len();
    let p = (all.iter().map(Comparison::p).fold(1.0, f64::min) * count as f64).min(1.0);
    let by_chance = 100.0 * (1.0 - 0.95f64.powi(count as i32));
    let farthest = all.iter().map(Comparison::reach).fold(0.0, f64::max);
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
