//! A quantity that was published: what it should be, what was measured, and what is to be said of the two.

use serde::{Deserialize, Serialize};

use crate::statistics::Mean;

/// Where a number comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Provenance {
    /// Taken from the source, or from a review that quotes it.
    Read,
    /// Recalled: the source was not at hand, so the band is generous and stands for a trend alone.
    Memory,
    /// Follows from what the scene is, by approximations that the experiment names.
    Derived,
    /// Follows from what the scene is, without any.
    Exact,
}

impl Provenance {
    /// In words.
    pub(super) const fn words(self) -> &'static str {
        match self {
            Self::Read => "read",
            Self::Memory => "memory",
            Self::Derived => "derived",
            Self::Exact => "exact",
        }
    }
}

/// What a quantity should be.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Expected {
    /// The published value, or the middle of what was published.
    pub value: f64,
    /// What is within counts as the same: the spread of what was published, or what the experiment's size and its
    /// idealisations leave open.
    pub low: f64,
    /// See `low`.
    pub high: f64,
    pub provenance: Provenance,
    /// Who says so, or how it follows.
    pub source: &'static str,
}

/// Whether the measured agrees with the published.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The whole interval lies within the band.
    Agrees,
    /// The whole interval lies outside.
    Differs,
    /// Part of it does, or there is none.
    NotDecided,
}

impl Verdict {
    /// Of what was measured against a band.
    pub(super) fn of(measured: &Mean, expected: &Expected) -> Self {
        let Mean { low, high, .. } = *measured;
        if low >= expected.low && high <= expected.high {
            Self::Agrees
        } else if high < expected.low || low > expected.high {
            Self::Differs
        } else {
            Self::NotDecided
        }
    }

    /// In words.
    pub(super) const fn words(self) -> &'static str {
        match self {
            Self::Agrees => "agrees",
            Self::Differs => "differs",
            Self::NotDecided => "not decided",
        }
    }
}

/// A quantity of an experiment that was computed in one way.
#[derive(Clone, Debug)]
pub(super) struct Quantity {
    /// What it is, with its unit.
    pub name: String,
    /// How large the systems were, in words.
    pub system: String,
    pub expected: Expected,
    pub measured: Mean,
}

impl Quantity {
    /// What was measured, against the low end of a band, the published value, and the high end; with where these come
    /// from and who says so.
    pub(super) fn new(
        name: impl Into<String>,
        system: &str,
        measured: Mean,
        [low, value, high]: [f64; 3],
        (provenance, source): (Provenance, &'static str),
    ) -> Self {
        let expected = Expected { value, low, high, provenance, source };
        Self { name: name.into(), system: system.to_owned(), expected, measured }
    }

    /// Relative deviation of the mean from the published value.
    pub(super) fn error(&self) -> f64 {
        (self.measured.mean / self.expected.value - 1.0).abs()
    }

    /// What is to be said of it where all runs are sound.
    pub(super) fn verdict(&self) -> Verdict {
        Verdict::of(&self.measured, &self.expected)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::mean;

    fn quantity(values: &[f64]) -> Quantity {
        let of = (Provenance::Exact, "arithmetic");
        Quantity::new("two", "", mean(values), [1.9, 2.0, 2.1], of)
    }

    #[test]
    fn a_verdict_can_come_out_each_way() {
        assert_eq!(quantity(&[2.0, 2.01, 1.99]).verdict(), Verdict::Agrees);
        assert_eq!(quantity(&[2.3, 2.31, 2.29]).verdict(), Verdict::Differs);
        assert_eq!(quantity(&[1.3, 1.31, 1.29]).verdict(), Verdict::Differs);
        // It straddles an end of the band, or holds all of it.
        assert_eq!(quantity(&[2.1, 2.11, 2.09]).verdict(), Verdict::NotDecided);
        assert_eq!(quantity(&[1.0, 2.0, 3.0]).verdict(), Verdict::NotDecided);
        // One value alone tells nothing of its spread, and what is no number tells nothing.
        assert_eq!(quantity(&[2.0]).verdict(), Verdict::NotDecided);
        assert_eq!(quantity(&[f64::NAN, 2.0]).verdict(), Verdict::NotDecided);
        assert!((quantity(&[2.2, 2.2]).error() - 0.1).abs() < 1e-12);
    }
}
