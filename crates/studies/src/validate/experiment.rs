//! Defines experiments, which compare simulations with publications. An experiment consists of cases (runs to compute)
//! and of published quantities with which the results are compared.

use super::variants::StepVariant;
use crate::error::Result;
pub(super) use crate::harness::{Effort, MeasuredCase, Measurements, RunReadings, named};
use crate::statistics::{Mean, mean};

pub(super) struct Experiment {
    pub name: &'static str,
    /// Heading of the experiment's section in the report, and of its chart.
    pub title: &'static str,
    /// Description of the experiment, with references.
    pub about: &'static str,
    pub cases: ExperimentCases,
    /// Table of published quantities as text, with one row per quantity: name | lower end of the band of values that
    /// agree, published value, upper end of the band | kind of the source: source.
    pub published: &'static str,
    /// Function that computes, from the results of all cases with one solver variant, the measured values of each
    /// published quantity, in the order of `published`.
    pub judge: fn(&Measurements) -> Vec<Measured>,
}

impl Experiment {
    pub(super) fn rows(&self) -> impl Iterator<Item = &'static str> {
        self.published.lines().filter(|row| !row.trim().is_empty())
    }
}

/// Function that returns the cases (runs to compute) of an experiment, for a quick pass (a pass with fewer and smaller
/// systems) or for the full pass.
pub(super) enum ExperimentCases {
    /// The experiment prescribes the solver methods of its cases, and ignores the methods that the user chooses.
    Own(fn(Effort) -> Vec<ExperimentCase>),
    /// The cases are run with each solver variant that the user chooses. The function returns no cases for a variant
    /// that the experiment cannot use.
    Chosen(fn(Effort, StepVariant) -> Vec<ExperimentCase>),
}

pub(super) struct ExperimentCase {
    /// Names and values of the parameters that distinguish this case from the other cases of the same experiment and
    /// solver variant.
    pub at: Vec<(&'static str, f64)>,
    /// Expected computing time, in a unit that all cases share: number of grains times number of steps.
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

/// Returns one case (a run to compute) for each value in `values` and each seed from 1 to `seeds`. The function `case`
/// makes the case of a value and a seed.
pub(super) fn seeded<T: Copy>(
    values: &[T],
    seeds: u32,
    case: impl Fn(T, u64) -> ExperimentCase,
) -> Vec<ExperimentCase> {
    let of = |&value: &T| (1..=u64::from(seeds)).map(move |seed| (value, seed));
    values.iter().flat_map(of).map(|(value, seed)| case(value, seed)).collect()
}

/// Origin of a published number: how reliable it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SourceKind {
    /// The number was read in the source, or in a review that quotes the source.
    Read,
    /// The number was written down from memory. Nobody has looked it up, so it gets no verdict.
    Memory,
    /// The number was derived from theory for the simulated scene, with approximations that the experiment names.
    Derived,
    /// The number was derived from theory for the simulated scene, without approximations.
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

/// Verdict on a measured value: the result of its comparison with the published value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Agreement {
    Agrees,
    Differs,
    /// The confidence interval of the measured value is partly inside and partly outside the published band, there is
    /// no measured value, or a run failed.
    NotDecided,
    /// The measured value is not judged, because the published number was written down from memory and nobody has
    /// looked it up.
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

/// Values of a published quantity, measured in simulations with one solver variant: a description of the simulated
/// system, and one value per seed or run.
pub(super) type Measured = (String, Vec<f64>);

/// A published quantity, and its mean in simulations with one solver variant.
#[derive(Clone, Debug)]
pub(super) struct PublishedQuantity {
    pub name: &'static str,
    pub system: String,
    /// The published value, or the centre of the published values.
    pub published: f64,
    /// Band of values that agree with the published value: lower and upper end. Its width is the spread of published
    /// values, or the uncertainty due to the size of the simulated system and its idealisations.
    pub band: [f64; 2],
    pub kind: SourceKind,
    /// Reference to the publication, or the derivation of the number.
    pub source: &'static str,
    pub measured: Mean,
}

impl PublishedQuantity {
    /// Reads a row of a table of published values, and computes the mean of the measured `values`. The row has the
    /// form: name | lower end of the band of values that agree, published value, upper end of the band | kind of the
    /// source: source. If the name begins with `rank correlation`, the confidence interval is limited to −1 … 1,
    /// because a correlation cannot be larger. Returns `None` if the row has another form.
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

    /// Returns the relative deviation of the measured mean from the published value; `None` if the published value is
    /// 0.
    pub(super) fn error(&self) -> Option<f64> {
        (self.published != 0.0).then(|| (self.measured.mean / self.published - 1.0).abs())
    }

    /// Returns the verdict on the measured value, provided that all runs succeeded.
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
        // The interval straddles an end of the band, or contains the whole band.
        assert_eq!(quantity(&[2.1, 2.11, 2.09]).verdict(), Agreement::NotDecided);
        assert_eq!(quantity(&[1.0, 2.0, 3.0]).verdict(), Agreement::NotDecided);
        // A single value gives no spread, and NaN gives no result.
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
        // Student's interval of these values would reach 1.27.
        let few = of(&[1.0, 1.0, 0.5, 1.0]);
        assert_eq!(few.measured.high, 1.0);
        assert_eq!(few.verdict(), Agreement::NotDecided);
        assert_eq!(of(&[0.9, 1.0, 1.0, 0.95]).verdict(), Agreement::Agrees);
        assert_eq!(of(&[-1.0, -1.0, -0.95, -1.0]).verdict(), Agreement::Differs);
        assert_eq!(of(&[-1.0, -1.0, -0.5, -1.0]).measured.low, -1.0);
    }

    #[test]
    fn tables_have_a_row_for_each_quantity() {
        // Some rows only concern layers with a prescribed bond energy, others cliffs under the second law (`way` 1 and
        // `law` 1 of `three_cohesions`), so the case has these parameters.
        let at = vec![("energy", 1.0), ("way", 1.0), ("law", 1.0), ("seed", 1.0)];
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
