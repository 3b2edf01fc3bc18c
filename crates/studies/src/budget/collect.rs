//! Chooses and computes the runs of an error budget. At first, every variant (the scene with one change) is run from a
//! few initial states, the variant with the shortest computing time first. Then the variant whose effect has the widest
//! confidence interval is run from more initial states. This is repeated until all intervals are as narrow as requested
//! or the computing time is used up.

use std::ops::ControlFlow;

use rayon::prelude::*;

use super::starts::RunValues;
use crate::error::Result;
use crate::output::Progress;
use crate::statistics::{Mean, mean, mean_with};

/// Least number of initial states of a series (all runs of an error budget with the same change of the scene). A series
/// ends when its confidence interval is narrow, so a series whose few values are close together by chance ends too
/// early, and an effect is reported by mistake. Such mistakes are allowed in 5 % of error budgets. In 3,000 made-up
/// error budgets without any effect they occurred in 7.7 % with 4 initial states, and in 5.4 % with 6 initial states.
const FIRST: usize = 6;
/// Allowed fraction of error budgets in which at least one confidence interval misses the true value.
pub(super) const OUTSIDE: f64 = 0.05;
/// Default of the requested half-width of confidence intervals, as a fraction of the value of the quantity.
const PART: f64 = 0.1;

/// Identifies a run of an error budget. `series` is the number of the change of the scene (0 for the unchanged scene),
/// and `start` the number of the initial state, counted from 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SeriesRun {
    pub series: usize,
    pub start: usize,
}

/// Results of a finished run, and the computing time that the run and its initial state took, s.
#[derive(Clone, Debug)]
pub(super) struct Ran {
    pub values: RunValues,
    pub secs: f64,
    /// True if another process that works on the same error budget, for example on another machine, has computed the
    /// run. The time of the run then does not count towards the time limit of this process.
    pub is_free: bool,
}

/// Limits of the runs of an error budget: computing time, and requested accuracy.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    /// Limit of the total computing time of all runs, core seconds.
    pub cost_secs: f64,
    /// Requested half-width of every confidence interval, in the unit of the examined quantity; `None` for a tenth of
    /// the quantity's value.
    pub within: Option<f64>,
    /// Number of parts into which the error budget is divided, for example for several machines. All parts together
    /// have this many times the initial states of one part.
    pub parts: usize,
    /// True to show a progress bar on stderr.
    pub shows_progress: bool,
}

/// Reason why the computation of an error budget ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum BudgetEnd {
    /// Every confidence interval is as narrow as requested.
    Within,
    /// The limit of the computing time was reached.
    Cost,
    /// The caller stopped the computation: the function `watch`, which is called after each stage, returned `Break`.
    Stopped,
    /// No quantity has a value, because runs of the unchanged scene failed.
    Failed,
}

/// All runs of an error budget that are finished so far.
pub(super) struct Runs {
    /// Finished runs. The first index is the series (all runs with the same change of the scene; 0 is the unchanged
    /// scene), the second index is the initial state.
    pub all: Vec<Vec<Ran>>,
    pub quantities: usize,
    /// Requested half-width of the confidence intervals of each quantity, in the unit of the quantity.
    pub within: Vec<f64>,
    /// Expected computing time of a run of each series (all runs with the same change of the scene), divided by the
    /// time of a run of the unchanged scene. The expectation is used until a run of the series has been timed.
    costs: Vec<f64>,
}

impl Runs {
    /// Returns an empty collection of runs. `costs` contains, for each series (all runs with the same change of the
    /// scene), the expected computing time of a run divided by the time of a run of the unchanged scene.
    fn new(costs: Vec<f64>, quantities: usize) -> Self {
        let all = costs.iter().map(|_| Vec::new()).collect();
        Self { all, quantities, within: Vec::new(), costs }
    }

    /// Returns the confidence level of a single confidence interval. It is so high that at most the fraction
    /// [`OUTSIDE`] of all error budgets has an interval that misses its true value (Bonferroni).
    pub(super) fn confidence(&self) -> f64 {
        // There is one interval per series, and one more for the limit Δt → 0 of the time step.
        1.0 - OUTSIDE / ((self.all.len() + 1) * self.quantities) as f64
    }

    /// Returns the mean of a number over the initial states, with its confidence interval. `series` lists series of
    /// runs (a series: all runs with the same change of the scene). For each initial state, `of` computes the number
    /// from the values of the quantity in these series. Initial states for which a series has no value are left out.
    pub(super) fn over_starts(
        &self,
        series: &[usize],
        quantity: usize,
        of: impl Fn(&[f64]) -> f64,
    ) -> Mean {
        let shared = series.iter().map(|&one| self.all[one].len()).min().unwrap_or(0);
        let at = |start: usize| -> Option<f64> {
            let value = |&one: &usize| self.value(one, start, quantity);
            let values: Option<Vec<f64>> = series.iter().map(value).collect();
            values.map(|values| of(&values))
        };
        let values: Vec<f64> = (0..shared).filter_map(at).collect();
        mean_with(&values, self.confidence())
    }

    fn value(&self, series: usize, start: usize, quantity: usize) -> Option<f64> {
        let values = &self.all[series].get(start)?.values;
        values.values[quantity].filter(|_| values.failure.is_none())
    }

    /// Returns the mean of a quantity in the unchanged scene if `series` is 0, otherwise the mean effect on the
    /// quantity of the change with the number `series`. The result contains a confidence interval.
    pub(super) fn interval(&self, series: usize, quantity: usize) -> Mean {
        if series == 0 {
            self.over_starts(&[0], quantity, |values| values[0])
        } else {
            self.over_starts(&[series, 0], quantity, |values| values[0] - values[1])
        }
    }

    /// Returns the reason why a series (the runs with the same change of the scene) gives no value of a quantity, as
    /// text: the number of failed runs, and the message of the first failed run. Returns `None` if all runs gave a
    /// value.
    pub(super) fn failure(&self, series: usize, quantity: usize) -> Option<String> {
        let runs = &self.all[series];
        let failed =
            |ran: &&Ran| ran.values.failure.is_some() || ran.values.values[quantity].is_none();
        let first = runs.iter().find(failed)?;
        let count = runs.iter().filter(failed).count();
        let reason = first.values.failure.as_deref().unwrap_or("it has no such number");
        Some(format!("{count} of {} runs came to nothing: {reason}", runs.len()))
    }

    /// Returns the computing time of a series of runs, divided by the computing time of the unchanged scene from the
    /// same initial states.
    pub(super) fn cost_ratio(&self, series: usize) -> f64 {
        let shared = self.all[series].len().min(self.all[0].len());
        let secs =
            |one: usize| self.all[one][..shared].iter().map(|ran| ran.values.run_secs).sum::<f64>();
        secs(series) / secs(0)
    }

    /// True if a series (the runs with the same change of the scene) has enough runs for its effect to be reported.
    pub(super) fn is_begun(&self, series: usize) -> bool {
        self.all[series].len() >= FIRST
    }

    fn secs_a_run(&self, series: usize) -> f64 {
        let mean_of = |one: usize, secs: fn(&Ran) -> f64| {
            let runs = &self.all[one];
            runs.iter().map(secs).sum::<f64>() / runs.len() as f64
        };
        if self.all[series].is_empty() {
            self.costs[series] * mean_of(0, |ran| ran.values.run_secs)
        } else {
            mean_of(series, |ran| ran.secs)
        }
    }

    fn spent_secs(&self) -> f64 {
        self.all.iter().flatten().filter(|ran| !ran.is_free).map(|ran| ran.secs).sum()
    }

    /// Returns the largest ratio, over all quantities, of the width of the confidence interval of a series (the runs
    /// with the same change of the scene) to the requested width. Quantities without values or whose values are all
    /// equal do not count; if no quantity counts, the ratio is 0.
    pub(super) fn excess(&self, series: usize) -> f64 {
        let of = |quantity: usize| {
            if [0, series].iter().any(|&one| self.failure(one, quantity).is_some()) {
                return 0.0;
            }
            let interval = self.interval(series, quantity);
            let half = interval.high - interval.mean;
            if half == 0.0 { 0.0 } else { half / self.within[quantity] }
        };
        (0..self.quantities).map(of).fold(0.0, f64::max)
    }
}

/// Computes the runs of an error budget until all confidence intervals are as narrow as requested, the limit of the
/// computing time is reached, or `watch` returns `Break`.
pub(super) fn collect(
    costs: Vec<f64>,
    quantities: usize,
    limits: Limits,
    (run, is_free): (
        &(impl Fn(SeriesRun) -> Result<Ran> + Sync),
        &impl Fn(SeriesRun) -> Result<bool>,
    ),
    watch: &mut impl FnMut(&Runs) -> ControlFlow<()>,
) -> Result<(Runs, BudgetEnd)> {
    let mut runs = Runs::new(costs, quantities);
    let secs_of = |runs: &Runs, jobs: &[SeriesRun]| -> Result<f64> {
        let secs =
            |job: &SeriesRun| Ok(if is_free(*job)? { 0.0 } else { runs.secs_a_run(job.series) });
        jobs.iter().map(secs).sum()
    };
    take(&mut runs, first(0).collect(), limits.shows_progress, run)?;
    runs.within = (0..quantities)
        .map(|quantity| limits.within.unwrap_or_else(|| width(&runs, quantity)))
        // The width of an interval decreases with the square root of the number of initial states. One part has only a
        // fraction of the initial states, so its own intervals may be wider than requested.
        .map(|within| within * (limits.parts as f64).sqrt())
        .collect();
    if (0..quantities).all(|quantity| runs.failure(0, quantity).is_some()) {
        return Ok((runs, BudgetEnd::Failed));
    }
    loop {
        if watch(&runs).is_break() {
            return Ok((runs, BudgetEnd::Stopped));
        }
        let left = limits.cost_secs - runs.spent_secs();
        let mut jobs = begun(&runs, left, &secs_of)?;
        if jobs.is_empty() {
            match widened(&runs, left, &secs_of)? {
                Ok(more) => jobs = more,
                Err(ended) => return Ok((runs, ended)),
            }
        }
        take(&mut runs, jobs, limits.shows_progress, run)?;
    }
}

/// Returns the first runs of a series (the runs with the same change of the scene), one from each of the first
/// [`FIRST`] initial states.
fn first(series: usize) -> impl Iterator<Item = SeriesRun> {
    (0..FIRST).map(move |start| SeriesRun { series, start })
}

/// Returns the default of the requested half-width of the confidence intervals of a quantity, in the unit of the
/// quantity and rounded to one digit.
fn width(runs: &Runs, quantity: usize) -> f64 {
    let values: Vec<f64> = (0..FIRST).filter_map(|start| runs.value(0, start, quantity)).collect();
    let mean = mean(&values);
    let spread = mean.spread();
    let rough = PART * mean.mean.abs().max(if spread.is_finite() { spread } else { 0.0 });
    format!("{rough:.0e}").parse().unwrap_or(rough)
}

/// Returns the next runs to compute for those series (all runs with the same change of the scene) that have fewer than
/// [`FIRST`] runs, the series with the shortest time per run first. Only runs that fit into the remaining computing
/// time `left_secs` (s) are returned; `secs_of` estimates the time of runs. A series without runs gets a single run,
/// because the time of a run under an expensive contact law is only known to a factor of ten before one run has been
/// timed.
fn begun(
    runs: &Runs,
    left_secs: f64,
    secs_of: &impl Fn(&Runs, &[SeriesRun]) -> Result<f64>,
) -> Result<Vec<SeriesRun>> {
    let mut new: Vec<usize> =
        (0..runs.all.len()).filter(|&series| !runs.is_begun(series)).collect();
    new.sort_by(|one, other| runs.secs_a_run(*one).total_cmp(&runs.secs_a_run(*other)));
    let (mut left, mut jobs) = (left_secs, Vec::new());
    for series in new {
        let had = runs.all[series].len();
        let more: Vec<SeriesRun> = first(series).skip(had).collect();
        left -= secs_of(runs, &more)?;
        if left >= 0.0 {
            jobs.extend(more.into_iter().take(if had == 0 { 1 } else { FIRST }));
        }
    }
    Ok(jobs)
}

/// Returns further runs for the series (the runs with the same change of the scene) that has the widest confidence
/// interval. If these runs do not fit into the remaining computing time `left_secs` (s), returns runs for the series
/// with the next narrower interval; `secs_of` estimates the time of runs. Returns the reason for the end of the
/// computation if all intervals are as narrow as requested, or if no further runs fit.
fn widened(
    runs: &Runs,
    left_secs: f64,
    secs_of: &impl Fn(&Runs, &[SeriesRun]) -> Result<f64>,
) -> Result<std::result::Result<Vec<SeriesRun>, BudgetEnd>> {
    let begun = (0..runs.all.len()).filter(|&series| runs.is_begun(series));
    let mut wide: Vec<(f64, usize)> = begun
        .map(|series| (runs.excess(series), series))
        .filter(|(excess, _)| *excess > 1.0)
        .collect();
    if wide.is_empty() {
        let is_whole = (0..runs.all.len()).all(|series| runs.is_begun(series));
        return Ok(Err(if is_whole { BudgetEnd::Within } else { BudgetEnd::Cost }));
    }
    wide.sort_by(|one, other| other.0.total_cmp(&one.0));
    for (excess, series) in wide {
        let count = runs.all[series].len();
        // The width of an interval decreases with the square root of the number of runs. The number is at most doubled
        // at once, because the scatter is not known well.
        let needed = (count as f64 * (excess * excess - 1.0)).ceil().clamp(1.0, count as f64);
        let missing = |one: usize, to: usize| {
            (runs.all[one].len()..to).map(move |start| SeriesRun { series: one, start })
        };
        let mut more = needed as usize;
        while more > 0 {
            let to = count + more;
            let jobs: Vec<SeriesRun> =
                missing(series, to).chain(missing(0, if series == 0 { 0 } else { to })).collect();
            if secs_of(runs, &jobs)? <= left_secs {
                return Ok(Ok(jobs));
            }
            more /= 2;
        }
    }
    Ok(Err(BudgetEnd::Cost))
}

/// Computes the runs `jobs` on all cores, the longest run first, and adds their results to `runs`.
fn take(
    runs: &mut Runs,
    mut jobs: Vec<SeriesRun>,
    shows_progress: bool,
    run: &(impl Fn(SeriesRun) -> Result<Ran> + Sync),
) -> Result<()> {
    let cost =
        |job: &SeriesRun| if runs.all[0].is_empty() { 1.0 } else { runs.secs_a_run(job.series) };
    jobs.sort_by(|one, other| cost(other).total_cmp(&cost(one)));
    let progress = shows_progress.then(|| Progress::new("budget", jobs.len() as u64));
    let done: Result<Vec<(SeriesRun, Ran)>> = jobs
        .into_par_iter()
        .map(|job| {
            let ran = run(job)?;
            progress.iter().for_each(|progress| progress.advance(1));
            Ok((job, ran))
        })
        .collect();
    progress.iter().for_each(Progress::finish);
    let mut done = done?;
    done.sort_by_key(|(job, _)| (job.series, job.start));
    for (job, ran) in done {
        debug_assert_eq!(runs.all[job.series].len(), job.start);
        runs.all[job.series].push(ran);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quantity_that_the_scene_does_not_have_takes_no_time_from_one_that_it_has() {
        // Only the variant has a value of the second quantity, just as only runs with the stepper `range` have an
        // energy of bonds.
        let run = |SeriesRun { series, start }: SeriesRun| {
            let only_of_the_variant = (series > 0).then_some(1.0);
            let values = vec![Some(0.01 * (start % 3) as f64), only_of_the_variant];
            let values = RunValues { values, failure: None, unsolved: 0.0, run_secs: 1.0 };
            Ok(Ran { values, secs: 1.0, is_free: false })
        };
        let limits =
            Limits { cost_secs: 10_000.0, within: Some(0.005), parts: 1, shows_progress: false };
        let go_on = &mut |_: &Runs| ControlFlow::Continue(());
        let (runs, ended) =
            collect(vec![1.0, 1.0], 2, limits, (&run, &|_| Ok(false)), go_on).expect("a budget");
        assert_eq!(ended, BudgetEnd::Within);
        let starts = runs.all[0].len();
        assert!((8..200).contains(&starts), "{starts} starts");
    }
}
