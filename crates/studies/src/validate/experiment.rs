//! What an experiment is: cases that are computed, and published quantities that are held against what they come to.

use super::variants::StepVariant;
use crate::error::Result;
pub(super) use crate::harness::{Effort, MeasuredCase, Measurements, RunReadings, named};
use crate::statistics::{Mean, mean};

pub(super) struct Experiment {
    pub name: &'static str,
    /// Above its part of the report and its chart.
    pub title: &'static str,
    /// What is done, and after whom.
    pub about: &'static str,
    pub cases: ExperimentCases,
    /// The published quantities, a row each ([`PublishedQuantity::new`]).
    pub published: &'static str,
    /// The values of each row that the cases of one solver variant measured.
    pub judge: fn(&Measurements) -> Vec<Measured>,
}

impl Experiment {
    pub(super) fn rows(&self) -> impl Iterator<Item = &'static str> {
        self.published.lines().filter(|row| !row.trim().is_empty())
    }
}

/// The cases of an experiment, those of a quick pass where that is asked for.
pub(super) enum ExperimentCases {
    /// It is about methods of its own, whichever are chosen.
    Own(fn(Effort) -> Vec<ExperimentCase>),
    /// It is computed by each variant that is chosen, but for those by which it has no cases.
    Chosen(fn(Effort, StepVariant) -> Vec<ExperimentCase>),
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
    /// Recalled: nobody has looked the number up, so that it gets no verdict.
    Memory,
    /// Follows from the scene, by approximations that the experiment names.
    Derived,
    /// Follows from the scene, without any.
    Exact,
}

impl SourceKind {
    const ALL: [Self; 4] = [Self::Read, Self::Memory, Self::Derived, Self::Exact];

    pub(super) const fn words(self) -> &'static str {
        match self {
            Self::Read => "read",
            Self::Memory => "recalled",
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
    /// The published number was recalled.
    NoVerdict,
}

impl Agreement {
    pub(super) const fn words(self) -> &'static str {
        match self {
            Self::Agrees => "agrees",
            Self::Differs => "differs",
            Self::NotDecided => "not decided",
            Self::NoVerdict => "no verdict",
        }
    }
}

/// The values of a published quantity that one solver variant measured: the system, and a value for each seed or run.
pub(super) type Measured = (String, Vec<f64>);

/// A published quantity, and its mean as one solver variant measured it.
#[derive(Clone, Debug)]
pub(super) struct PublishedQuantity {
    pub name: &'static str,
    pub system: String,
    /// The published value, or the middle of the published values.
    pub published: f64,
    /// Values within it count as the same: the spread of published values, or the uncertainty from the experiment's size
    /// and its idealisations.
    pub band: [f64; 2],
    pub kind: SourceKind,
    /// Who says so, or how it follows.
    pub source: &'static str,
    pub measured: Mean,
}

impl PublishedQuantity {
    /// The quantity of a row of a table: name | low end of the band, published value, high end | kind of source: source.
    /// No correlation is larger than 1, so that the interval of a `rank correlation` ends there. None if the row says
    /// something else.
    pub(super) fn new(row: &'static str, (system, values): Measured) -> Option<Self> {
        let mut cells = row.split(" | ").map(str::trim);
        let (name, numbers, (kind, source)) =
            (cells.next()?, cells.next()?, cells.next()?.split_once(": ")?);
        let numbers: Vec<f64> = numbers
            .split_whitespace()
            .map(str::parse)
            .collect::<std::result::Result<_, _>>()
            .ok()?;
        let &[low, published, high] = &numbers[..] else { return None };
        let kind = SourceKind::ALL.into_iter().find(|known| known.words() == kind)?;
        let mut measured = mean(&values);
        if name.starts_with("rank correlation") {
            (measured.low, measured.high) = (measured.low.max(-1.0), measured.high.min(1.0));
        }
        Some(Self { name, system, published, band: [low, high], kind, source, measured })
    }

    /// Relative deviation of the mean from the published value; none where that is 0.
    pub(super) fn error(&self) -> Option<f64> {
        (self.published != 0.0).then(|| (self.measured.mean / self.published - 1.0).abs())
    }

    /// How the two compare, where all runs are sound.
    pub(super) fn verdict(&self) -> Agreement {
        let (Mean { low, high, .. }, band) = (self.measured, self.band);
        if self.kind == SourceKind::Memory {
            Agreement::NoVerdict
        } else if low >= band[0] && high <= band[1] {
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
        let row = "two | 1.9 2 2.1 | exact: arithmetic";
        PublishedQuantity::new(row, (String::new(), values.to_vec())).expect("a row")
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
        let row = "none | -0.1 0 0.1 | exact: arithmetic";
        let values = || (String::new(), vec![0.01, 0.02]);
        let of_none = PublishedQuantity::new(row, values()).expect("a row");
        assert_eq!(of_none.error(), None);
        let recalled = "none | -0.1 0 0.1 | recalled: arithmetic";
        let recalled = PublishedQuantity::new(recalled, values()).expect("a row");
        assert_eq!(recalled.verdict(), Agreement::NoVerdict);
    }

    #[test]
    fn no_correlation_is_beyond_1() {
        let of = |values: &[f64]| {
            let row = "rank correlation | 0.5 1 1 | read: it grows";
            PublishedQuantity::new(row, (String::new(), values.to_vec())).expect("a row")
        };
        // Student's interval would reach 1.27.
        let few = of(&[1.0, 1.0, 0.5, 1.0]);
        assert_eq!(few.measured.high, 1.0);
        assert_eq!(few.verdict(), Agreement::NotDecided);
        assert_eq!(of(&[0.9, 1.0, 1.0, 0.95]).verdict(), Agreement::Agrees);
        assert_eq!(of(&[-1.0, -1.0, -0.95, -1.0]).verdict(), Agreement::Differs);
        assert_eq!(of(&[-1.0, -1.0, -0.5, -1.0]).measured.low, -1.0);
    }

    #[test]
    fn tables_have_a_row_for_each_quantity() {
        // Some quantities are of layers whose bonds have an energy.
        let at = vec![("energy", 1.0)];
        let case = MeasuredCase { at, run: RunReadings::default(), wall_secs: 0.0 };
        for experiment in &super::super::EXPERIMENTS {
            let judged = (experiment.judge)(&Measurements(vec![&case])).len();
            let rows: Vec<_> = experiment.rows().collect();
            assert_eq!(judged, rows.len(), "{}", experiment.name);
            for row in rows {
                assert!(PublishedQuantity::new(row, Measured::default()).is_some(), "{row}");
            }
        }
    }
}
