//! Computes the runs of the experiments: every case of every experiment with every solver variant.

use super::experiment::*;
use super::variants::{SolveBudget, StepVariant};
use crate::error::{Error, Result};
use crate::harness::{Case, Runner, Threads};

pub(super) struct ExperimentRuns {
    pub experiment: &'static Experiment,
    /// Solver variant of the runs; `None` if the experiment prescribes its solver methods.
    pub variant: Option<StepVariant>,
    pub cases: Vec<MeasuredCase>,
}

impl ExperimentRuns {
    pub(super) fn words(&self) -> String {
        words(self.variant)
    }

    /// Returns the reason why no verdict is possible, in words: some runs failed, so the remaining runs are not a fair
    /// sample. Returns `None` if no run failed.
    pub(super) fn spoilt(&self) -> Option<String> {
        let blew_up = self.cases.iter().filter(|case| case.run.blew_up).count();
        let lost = self.cases.iter().filter(|case| case.run.lost_grains > 0).count();
        let runs = self.cases.len();
        (blew_up + lost > 0).then(|| {
            format!("of {runs} runs {blew_up} were no longer finite and {lost} lost grains")
        })
    }

    pub(super) fn judged(&self) -> Vec<(PublishedQuantity, Agreement)> {
        let sound = Measurements(self.cases.iter().filter(|case| !case.run.blew_up).collect());
        let is_spoilt = self.spoilt().is_some();
        let judge = |(row, measured)| {
            let quantity = PublishedQuantity::new(row, measured)?;
            let verdict = match quantity.verdict() {
                Agreement::NoVerdict => Agreement::NoVerdict,
                _ if is_spoilt => Agreement::NotDecided,
                verdict => verdict,
            };
            Some((quantity, verdict))
        };
        self.experiment.rows().zip((self.experiment.judge)(&sound)).filter_map(judge).collect()
    }

    /// True if the steps of these runs are not solved to a tolerance: the solver makes a given number of sweeps, or the
    /// stepper has no tolerance.
    pub(super) fn has_sweeps_alone(&self) -> bool {
        self.variant.is_none_or(|StepVariant { stepper, budget, .. }| {
            !stepper.reads("solver") || matches!(budget, SolveBudget::Sweeps(_))
        })
    }

    pub(super) fn wall_secs(&self) -> f64 {
        self.cases.iter().map(|case| case.wall_secs).sum()
    }

    pub(super) fn speed(&self) -> f64 {
        let simulated: f64 = self.cases.iter().map(|case| case.run.simulated_secs).sum();
        simulated / self.wall_secs()
    }

    /// Returns the fraction of the steps of all runs that were not solved to their tolerance.
    pub(super) fn unsolved(&self) -> f64 {
        let sum = |number: fn(&RunReadings) -> u64| {
            self.cases.iter().map(|case| number(&case.run)).sum::<u64>() as f64
        };
        sum(|run| run.unsolved_steps) / sum(|run| run.steps).max(1.0)
    }
}

fn words(variant: Option<StepVariant>) -> String {
    variant.map_or("methods of its own".to_owned(), |variant| variant.words())
}

/// Computes the runs of `experiments` with every one of `variants`, except runs that are already finished. Returns all
/// runs in the order of the report.
pub(super) fn run_all(
    experiments: &[&'static Experiment],
    variants: &[StepVariant],
    effort: Effort,
    runner: &Runner<RunReadings>,
) -> Result<Vec<ExperimentRuns>> {
    let (mut all, mut cases) = (Vec::new(), Vec::new());
    for &experiment in experiments {
        let sets: Vec<(Option<StepVariant>, Vec<ExperimentCase>)> = match experiment.cases {
            ExperimentCases::Own(cases) => vec![(None, cases(effort))],
            ExperimentCases::Chosen(cases) => {
                variants.iter().map(|&variant| (Some(variant), cases(effort, variant))).collect()
            }
        };
        for (variant, set) in sets.into_iter().filter(|(_, cases)| !cases.is_empty()) {
            for case in set {
                let word = |(name, value): &(&str, f64)| format!("{name} {value}");
                let at: Vec<String> = case.at.iter().map(word).collect();
                let key = format!("{}; {}; {}", experiment.name, words(variant), at.join(", "));
                cases.push(Case { key, cost: case.cost, setup: (all.len(), case) });
            }
            all.push(ExperimentRuns { experiment, variant, cases: Vec::new() });
        }
    }
    let finished = runner.run(&cases, Threads::All, |(_, case)| match (case.run)() {
        Err(Error::NonFinite { .. }) => Ok(RunReadings { blew_up: true, ..RunReadings::default() }),
        readings => readings,
    })?;
    for (case, finished) in cases.into_iter().zip(finished) {
        let (number, ExperimentCase { at, .. }) = case.setup;
        let (run, wall_secs) = (finished.result, finished.wall_secs);
        all[number].cases.push(MeasuredCase { at, run, wall_secs });
    }
    Ok(all)
}
