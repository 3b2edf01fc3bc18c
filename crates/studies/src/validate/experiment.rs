//! What an experiment is: cases that are computed, and published quantities that are held against what they come to.

use super::variants::StepVariant;
use crate::error::Result;
pub(super) use crate::harness::{MeasuredCase, Measurements, RunReadings, named};
use crate::statistics::{Mean, mean};

pub(super) struct Experiment {
    pub name: &'static str,
    /// Above its part of the report and its chart.
    pub title: &'static str,
    /// What is done, and after whom.
    pub about: &'static str,
    pub cases: ExperimentCases,
    /// What the cases of one solver variant come to.
    pub judge: fn(&Measurements) -> Vec<PublishedQuantity>,
}

/// The cases of an experiment, those of a quick pass where that is asked for.
pub(super) enum ExperimentCases {
    /// It is about methods of its own, whichever are chosen.
    Own(fn(bool) -> Vec<ExperimentCase>),
    /// It is computed by each variant that is chosen, but for those by which it has no cases.
    Chosen(fn(bool, StepVariant) -> Vec<ExperimentCase>),
}

pub(super) struct ExperimentCase {
    /// Numbers that tell it from the others of its experiment and variant.
    pub at: Vec<(&'static str, f64)>,
    /// How long it may take, in the unit of all cases: grains times steps.
    pub cost: f64,
    pub run: Box<dyn Fn() -> Result<RunReadings> + Send + Sync>,
}

impl ExperimentCase {
    pub(super) fn new(
        at: &[(&'static str, f64)],
        cost: f64,
        run: impl Fn() -> Result<RunReadings> + Send + Sync + 'static,
    ) -> Self {
        Self { at: at.to_vec(), cost, run: Box::new(run) }
    }
}

/// A case for each value and each seed from 1 on.
pub(super) fn seeded<T: Copy>(
    values: &[T],
    seeds: u32,
    case: impl Fn(T, u64) -> ExperimentCase,
) -> Vec<ExperimentCase> {
    let of = |&value: &T| (1..=u64::from(seeds)).map(move |seed| (value, seed));
    values.iter().flat_map(of).map(|(value, seed)| case(value, seed)).collect()
}

/// Where a number comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SourceKind {
    /// Taken from the source, or from a review that quotes it.
    Read,
    /// Recalled: the source was not at hand, so the band is generous and stands for a trend alone.
    Memory,
    /// Follows from what the scene is, by approximations that the experiment names.
    Derived,
    /// Follows from what the scene is, without any.
    Exact,
}

impl SourceKind {
    pub(super) const fn words(self) -> &'static str {
        match self {
            Self::Read => "read",
            Self::Memory => "memory",
            Self::Derived => "derived",
            Self::Exact => "exact",
        }
    }
}

/// How the measured compares with the published.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Agreement {
    Agrees,
    Differs,
    /// Part of it does, or there is none.
    NotDecided,
}

impl Agreement {
    pub(super) const fn words(self) -> &'static str {
        match self {
            Self::Agrees => "agrees",
            Self::Differs => "differs",
            Self::NotDecided => "not decided",
        }
    }
}

/// A published quantity, and what was measured of it by one solver variant.
#[derive(Clone, Debug)]
pub(super) struct PublishedQuantity {
    pub name: String,
    pub system: String,
    /// The published value, or the middle of what was published.
    pub published: f64,
    /// What is within counts as the same: the spread of what was published, or what the experiment's size and its
    /// idealisations leave open.
    pub band: [f64; 2],
    pub provenance: SourceKind,
    /// Who says so, or how it follows.
    pub source: &'static str,
    pub measured: Mean,
}

impl PublishedQuantity {
    /// Independent values that were measured, against the low end of a band, the published value, and the high end.
    pub(super) fn new(
        name: impl Into<String>,
        system: &str,
        values: &[f64],
        [low, published, high]: [f64; 3],
        (provenance, source): (SourceKind, &'static str),
    ) -> Self {
        let (name, system) = (name.into(), system.to_owned());
        let (band, measured) = ([low, high], mean(values));
        Self { name, system, published, band, provenance, source, measured }
    }

    /// The mean rank correlation of runs that are apart from each other. None is larger than 1, so the interval ends there.
    pub(super) fn correlation(
        name: impl Into<String>,
        system: &str,
        values: &[f64],
        band: [f64; 3],
        source: (SourceKind, &'static str),
    ) -> Self {
        let mut quantity = Self::new(name, system, values, band, source);
        let Mean { low, high, .. } = &mut quantity.measured;
        (*low, *high) = (low.max(-1.0), high.min(1.0));
        quantity
    }

    /// Relative deviation of the mean from the published value; none where that is 0.
    pub(super) fn error(&self) -> Option<f64> {
        (self.published != 0.0).then(|| (self.measured.mean / self.published - 1.0).abs())
    }

    /// How the two compare, where all runs are sound.
    pub(super) fn verdict(&self) -> Agreement {
        let (Mean { low, high, .. }, band) = (self.measured, self.band);
        if low >= band[0] && high <= band[1] {
            Agreement::Agrees
        } else if high < band[0] || low > band[1] {
            Agreement::Differs
        } else {
            Agreement::NotDecided
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quantity(values: &[f64]) -> PublishedQuantity {
        let of = (SourceKind::Exact, "arithmetic");
        PublishedQuantity::new("two", "", values, [1.9, 2.0, 2.1], of)
    }

    #[test]
    fn a_verdict_can_come_out_each_way() {
        assert_eq!(quantity(&[2.0, 2.01, 1.99]).verdict(), Agreement::Agrees);
        assert_eq!(quantity(&[2.3, 2.31, 2.29]).verdict(), Agreement::Differs);
        assert_eq!(quantity(&[1.3, 1.31, 1.29]).verdict(), Agreement::Differs);
        // It straddles an end of the band, or holds all of it.
        assert_eq!(quantity(&[2.1, 2.11, 2.09]).verdict(), Agreement::NotDecided);
        assert_eq!(quantity(&[1.0, 2.0, 3.0]).verdict(), Agreement::NotDecided);
        // One value alone tells nothing of its spread, and what is no number tells nothing.
        assert_eq!(quantity(&[2.0]).verdict(), Agreement::NotDecided);
        assert_eq!(quantity(&[f64::NAN, 2.0]).verdict(), Agreement::NotDecided);
        assert!((quantity(&[2.2, 2.2]).error().expect("a value") - 0.1).abs() < 1e-12);
        let of = (SourceKind::Exact, "arithmetic");
        let of_none = PublishedQuantity::new("none", "", &[0.01, 0.02], [-0.1, 0.0, 0.1], of);
        assert_eq!(of_none.error(), None);
    }

    #[test]
    fn no_correlation_is_beyond_1() {
        let of = |values: &[f64]| {
            let source = (SourceKind::Memory, "it grows");
            PublishedQuantity::correlation("trend", "", values, [0.5, 1.0, 1.0], source)
        };
        // Student's interval would reach 1.27.
        let few = of(&[1.0, 1.0, 0.5, 1.0]);
        assert_eq!(few.measured.high, 1.0);
        assert_eq!(few.verdict(), Agreement::NotDecided);
        assert_eq!(of(&[0.9, 1.0, 1.0, 0.95]).verdict(), Agreement::Agrees);
        assert_eq!(of(&[-1.0, -1.0, -0.95, -1.0]).verdict(), Agreement::Differs);
        assert_eq!(of(&[-1.0, -1.0, -0.5, -1.0]).measured.low, -1.0);
    }
}
