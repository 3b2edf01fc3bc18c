//! What is asked of the slump of piles against Δt, state by state, with how often each test would say so by chance.

use super::chance::{self, Alike};
use super::verdict::{Claim, Verdict};
use super::workshop::Rows;
use crate::statistics::{Mean, mean, p_value, slope};

/// A pile whose slump changes by less than this per decade of Δt is flat: a tenth of what the paper's
/// cohesive piles do.
const FLAT_PER_DECADE: f64 = 0.02;

/// What was measured, over slumps of each initial state by log₁₀ Δt, rising; and whether the claim holds.
type Test = fn(&[Alike]) -> (String, Verdict);

/// A claim about one Bond.
pub(super) struct Asked {
    pub bond: f64,
    said: &'static str,
    test: Test,
    /// The slope a decade at the border of what the claim allows.
    border: f64,
}

/// The claims of Fig. 5a.
pub(super) const OF_FIG5A: [Asked; 4] = [
    Asked {
        bond: 0.0,
        said: "at Bond 0 the slump does not depend on Δt",
        test: flat,
        border: FLAT_PER_DECADE,
    },
    Asked { bond: 20.0, said: "at Bond 20 it falls as Δt grows", test: falling, border: 0.0 },
    Asked { bond: 50.0, said: "at Bond 50 it has a minimum", test: minimum, border: 0.0 },
    Asked { bond: 100.0, said: "at Bond 100 it rises as Δt grows", test: rising, border: 0.0 },
];

impl Asked {
    /// What becomes of the claim on the runs at its Bond, in a `cone`.
    pub(super) fn claim(&self, rows: &Rows<'_>, cone: &str, hangs_on: &str) -> Claim {
        let Self { bond, said, test, border } = *self;
        let states = by_state(&rows.such_that(|config| config.parameters.bond == Some(bond)));
        let (measured, verdict) = test(&states);
        let holds = |states: &[Alike]| test(states).1 == Verdict::Holds;
        let share = chance::share(&states, |log_step| border * log_step, holds);
        let said = format!("Fig. 5a, {cone} cone: {said}");
        Claim::new(said, measured, verdict).by_chance(chance::told(share)).hanging_on(hangs_on)
    }
}

/// Slumps of each state by log₁₀ Δt, rising.
pub(super) fn by_state(rows: &Rows<'_>) -> Vec<Alike> {
    let of_seed = |seed| {
        let rows = rows.such_that(|config| config.source.seed == Some(seed));
        let mut pairs: Alike = rows
            .0
            .iter()
            .map(|(config, outcome)| {
                (config.parameters.time_step_secs.unwrap_or(1.0).log10(), outcome.slump)
            })
            .collect();
        pairs.sort_by(|one, other| one.0.total_cmp(&other.0));
        pairs
    };
    rows.seeds().into_iter().map(of_seed).collect()
}

fn slopes(states: &[Alike]) -> Mean {
    mean(&states.iter().map(|pairs| slope(pairs)).collect::<Vec<_>>())
}

fn told(what: &str, mean: &Mean) -> String {
    let text = format!(
        "{what} {:+.3}, 95 % interval {:+.3} … {:+.3}, {} states",
        mean.mean, mean.low, mean.high, mean.count
    );
    text.replace('-', "−")
}

fn flat(states: &[Alike]) -> (String, Verdict) {
    let slope = slopes(states);
    let p = slope.p_within(FLAT_PER_DECADE);
    let p_not = slope.p_above(FLAT_PER_DECADE).min(slope.p_below(-FLAT_PER_DECADE));
    let told = told("slope per decade", &slope);
    (format!("{told}; within ±{FLAT_PER_DECADE}: {}", p_value(p)), Verdict::of(p, p_not))
}

fn falling(states: &[Alike]) -> (String, Verdict) {
    let slope = slopes(states);
    let p = slope.p_below(0.0);
    let told = told("slope per decade", &slope);
    (format!("{told}; below 0: {}", p_value(p)), Verdict::of(p, slope.p_above(0.0)))
}

fn rising(states: &[Alike]) -> (String, Verdict) {
    let slope = slopes(states);
    let p = slope.p_above(0.0);
    let told = told("slope per decade", &slope);
    (format!("{told}; above 0: {}", p_value(p)), Verdict::of(p, slope.p_below(0.0)))
}

/// Both ends lie above the mean of what is between them, state by state. Which Δt is lowest is not
/// asked, so that nothing is picked after the fact.
fn minimum(states: &[Alike]) -> (String, Verdict) {
    let rise = |end: fn(&Alike) -> f64| {
        let over = |pairs: &Alike| {
            let inner = &pairs[1..pairs.len() - 1];
            end(pairs) - inner.iter().map(|(_, slump)| slump).sum::<f64>() / inner.len() as f64
        };
        mean(&states.iter().filter(|pairs| pairs.len() > 2).map(over).collect::<Vec<_>>())
    };
    let left = rise(|pairs| pairs[0].1);
    let right = rise(|pairs| pairs[pairs.len() - 1].1);
    let p = left.p_above(0.0).max(right.p_above(0.0));
    let p_not = left.p_below(0.0).min(right.p_below(0.0));
    let measured = format!(
        "{}; {}; both above 0: {}",
        told("smallest Δt above those between", &left),
        told("largest Δt above those between", &right),
        p_value(p)
    );
    (measured, Verdict::of(p, p_not))
}
