//! Defines claims (statements that are tested on runs) with verdicts, and computes how often a test finds a claim true
//! by chance. To measure this rate, the time steps Δt are shuffled among runs that only differ in Δt, and the test is
//! repeated. The shuffle leaves the scatter of the results unchanged and removes every effect of Δt.

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64;

/// Significance level of the tests: a claim is found true if its p-value is below this level.
pub(super) const SIGNIFICANT: f64 = 0.05;

/// Upper end of a confidence interval, divided by its lower end, below which the interval is narrow enough to confirm a
/// value within it. A wider interval decides nothing.
const NARROW: f64 = 3.0;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    Holds,
    Fails,
    /// The measured data decide neither for nor against the tested statement.
    Open,
}

impl Verdict {
    /// Returns the verdict on a claim (a tested statement). `p` is the p-value of the claim and `p_contrary` the
    /// p-value of the opposite claim.
    pub(super) fn of(p: f64, p_contrary: f64) -> Self {
        match (p < SIGNIFICANT, p_contrary < SIGNIFICANT) {
            (true, _) => Self::Holds,
            (false, true) => Self::Fails,
            (false, false) => Self::Open,
        }
    }

    /// Returns the verdict on a guessed value, from the confidence interval `low` to `high` of the measured value. A
    /// guess outside the interval fails. A guess within the interval holds if `high` is less than [`NARROW`] times
    /// `low`; otherwise the verdict is open.
    pub(super) fn of_interval(guess: f64, low: f64, high: f64) -> Self {
        if guess < low || guess > high {
            Self::Fails
        } else if high < NARROW * low {
            Self::Holds
        } else {
            Self::Open
        }
    }

    pub(super) fn words(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Fails => "does not hold",
            Self::Open => "not decided by these data",
        }
    }
}

impl From<bool> for Verdict {
    fn from(holds: bool) -> Self {
        if holds { Self::Holds } else { Self::Fails }
    }
}

/// A claim (a statement that is tested on runs), its measurement, and the verdict.
#[derive(Clone, Debug)]
pub(super) struct Claim {
    /// The tested statement: a statement of Abramian & Staron (2020), or an additional statement.
    pub said: String,
    /// Measured value in words, with its confidence interval or p-value.
    pub measured: String,
    pub verdict: Verdict,
    /// How often the test would find the claim true by chance, in words; may be empty.
    pub by_chance: String,
    /// Choices that Abramian & Staron (2020) leave open and on which the verdict depends, such as the restitution; may
    /// be empty.
    pub hangs_on: String,
}

impl Claim {
    pub(super) fn new(
        said: impl Into<String>,
        measured: impl Into<String>,
        verdict: Verdict,
    ) -> Self {
        let [by_chance, hangs_on] = [String::new(), String::new()];
        Self { said: said.into(), measured: measured.into(), verdict, by_chance, hangs_on }
    }

    /// Adds a phrase to the claim (a tested statement). The phrase says how often the test would find the claim true by
    /// chance.
    pub(super) fn by_chance(self, by_chance: impl Into<String>) -> Self {
        Self { by_chance: by_chance.into(), ..self }
    }

    /// Measures how often the test `holds` finds the claim true by chance, and adds this rate to the claim, in words.
    /// The runs of each group in `groups` only differ in one number x, such as log₁₀ Δt. The results of the runs of a
    /// group are exchanged at random, which removes every effect of x. Then `border(x)` is added to each result: the
    /// strongest effect of x with which the claim is still false. This is repeated many times. The rate is the fraction
    /// of repetitions in which `holds` returns true.
    pub(super) fn shuffled(
        self,
        groups: &[Alike],
        border: impl Fn(f64) -> f64,
        holds: impl Fn(&[Alike]) -> bool,
    ) -> Self {
        let share = 100.0 * share_by_chance(groups, border, holds);
        self.by_chance(format!(
            "holds in {share:.1} % of {SHUFFLES} shuffles of Δt within each state"
        ))
    }

    pub(super) fn hanging_on(self, hangs_on: impl Into<String>) -> Self {
        Self { hangs_on: hangs_on.into(), ..self }
    }
}

/// Number of shuffles of the time steps, from which it is computed how often a test finds a claim true by chance. With
/// this number, a rate of 5 % is known to ± 1.4 % (95 % confidence interval).
const SHUFFLES: usize = 1000;

/// A group of runs that only differ in one number, such as log₁₀ Δt: for each run, this number and the result.
pub(super) type Alike = Vec<(f64, f64)>;

/// Returns the fraction of shuffles after which the test `holds` finds its claim true. The runs of each group in
/// `groups` only differ in one number x, such as log₁₀ Δt. Each shuffle exchanges the results of the runs within every
/// group at random, and then adds `border(x)` to each result: the strongest effect of x with which the claim is still
/// false.
fn share_by_chance(
    groups: &[Alike],
    border: impl Fn(f64) -> f64,
    holds: impl Fn(&[Alike]) -> bool,
) -> f64 {
    let mut random = Pcg64::seed_from_u64(1);
    let mut shuffled = |group: &Alike| -> Alike {
        let mut results: Vec<f64> = group.iter().map(|(_, result)| *result).collect();
        results.shuffle(&mut random);
        group.iter().zip(results).map(|((x, _), result)| (*x, result + border(*x))).collect()
    };
    let holding = (0..SHUFFLES)
        .filter(|_| holds(&groups.iter().map(&mut shuffled).collect::<Vec<_>>()))
        .count();
    holding as f64 / SHUFFLES as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::{mean, slope};

    /// Returns made-up results for tests: sixteen initial states with six time steps each. The results have a random
    /// scatter and decrease by `fall` per decade of the time step.
    fn states(fall: f64) -> Vec<Alike> {
        let of_state = |state: usize| {
            let run = |step: usize| {
                let scatter = (1.3 * state as f64 + 7.1 * (state * step) as f64).sin();
                (step as f64, 0.1 * scatter - fall * step as f64)
            };
            (0..6).map(run).collect()
        };
        (1..=16).map(of_state).collect()
    }

    fn falls(states: &[Alike]) -> bool {
        let slopes: Vec<f64> = states.iter().map(|state| slope(state)).collect();
        mean(&slopes).p_below(0.0) < SIGNIFICANT
    }

    #[test]
    fn a_sound_test_says_so_by_chance_in_five_of_a_hundred_whatever_the_effect() {
        for fall in [0.0, 0.02, 0.5] {
            let share = share_by_chance(&states(fall), |_| 0.0, falls);
            assert!((share - 0.05).abs() < 0.02, "{share} where it falls by {fall}");
        }
        assert!(falls(&states(0.02)) && !falls(&states(-0.02)));
    }

    #[test]
    fn one_that_always_says_so_is_found_out_and_the_border_counts() {
        assert_eq!(share_by_chance(&states(0.0), |_| 0.0, |_| true), 1.0);
        assert!(share_by_chance(&states(0.0), |step| -0.5 * step, falls) > 0.99);
    }
}
