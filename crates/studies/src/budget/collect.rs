//! Which runs a budget takes: each variant from a few starts, the cheapest first, then more starts where an interval is
//! the widest, until all are as narrow as asked for or the time is spent.

use std::ops::ControlFlow;

use rayon::prelude::*;

use super::starts::RunValues;
use crate::error::Result;
use crate::output::Progress;
use crate::statistics::{Mean, mean, mean_with};

/// Starts that a series has at least. A series ends when its interval is narrow, so that one whose few starts lie together by
/// chance ends too early: with 4, 7.7 % of 3,000 made-up budgets see an effect though nothing has one, with 6, 5.4 %.
const FIRST: usize = 6;
/// Share of budgets in which an interval may not hold the true value, of all that a budget has.
pub(super) const OUTSIDE: f64 = 0.05;
/// Where no other width is asked for: this part of the value.
const PART: f64 = 0.1;

/// A run of series `series`, 0 for the scene as it is, from start `start`, counted from 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SeriesRun {
    pub series: usize,
    pub start: usize,
}

/// A run and how long it took together with its start, s.
#[derive(Clone, Debug)]
pub(super) struct Ran {
    pub values: RunValues,
    pub secs: f64,
    /// True where a part has run it, whose time is not this budget's.
    pub is_free: bool,
}

/// How far a budget goes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    /// Core seconds.
    pub cost_secs: f64,
    /// Half the width of every interval, in the quantity's unit.
    pub within: Option<f64>,
    /// Parts that there are, of which this is one. Together they have so many times its starts.
    pub parts: usize,
    /// True where a bar on stderr shows how far it is.
    pub shows_progress: bool,
}

/// Why no more was computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum BudgetEnd {
    /// Every interval is as narrow as asked for.
    Within,
    /// The time is spent.
    Cost,
    /// Whoever watches wanted no more.
    Stopped,
    /// Runs of the scene as it is came to no number.
    Failed,
}

/// The runs so far.
pub(super) struct Runs {
    /// By series, then by start.
    pub all: Vec<Vec<Ran>>,
    pub quantities: usize,
    /// Half the width that intervals are to have, by quantity.
    pub within: Vec<f64>,
    /// What a run of each series may cost before one was measured, in runs of the first.
    costs: Vec<f64>,
}

impl Runs {
    /// `costs` are those of all series, the first of which is the scene as it is.
    fn new(costs: Vec<f64>, quantities: usize) -> Self {
        let all = costs.iter().map(|_| Vec::new()).collect();
        Self { all, quantities, within: Vec::new(), costs }
    }

    /// Share of samples in which a single interval holds the true value, for all of them to hold it together in all but
    /// [`OUTSIDE`] (Bonferroni).
    pub(super) fn confidence(&self) -> f64 {
        // Beside every series there is the value at Δt → 0.
        1.0 - OUTSIDE / ((self.all.len() + 1) * self.quantities) as f64
    }

    /// The values of a quantity over the starts at which some series all have one: `of` makes one number of theirs.
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

    /// The quantity of the scene as it is, or what a series adds to it.
    pub(super) fn interval(&self, series: usize, quantity: usize) -> Mean {
        if series == 0 {
            self.over_starts(&[0], quantity, |values| values[0])
        } else {
            self.over_starts(&[series, 0], quantity, |values| values[0] - values[1])
        }
    }

    /// Why a series comes to no number, if it does: in how many of its runs, and the first reason.
    pub(super) fn failure(&self, series: usize, quantity: usize) -> Option<String> {
        let runs = &self.all[series];
        let failed =
            |ran: &&Ran| ran.values.failure.is_some() || ran.values.values[quantity].is_none();
        let first = runs.iter().find(failed)?;
        let count = runs.iter().filter(failed).count();
        let reason = first.values.failure.as_deref().unwrap_or("it has no such number");
        Some(format!("{count} of {} runs came to nothing: {reason}", runs.len()))
    }

    /// What runs of a series cost, in those of the scene as it is from the same starts.
    pub(super) fn cost_ratio(&self, series: usize) -> f64 {
        let shared = self.all[series].len().min(self.all[0].len());
        let secs =
            |one: usize| self.all[one][..shared].iter().map(|ran| ran.values.run_secs).sum::<f64>();
        secs(series) / secs(0)
    }

    /// True where a series has as many runs as one needs to be told of.
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

    /// How many times as wide as asked for the widest interval of a series is; 0 where it has to be no narrower.
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

/// Takes runs until all intervals are narrow, the time is spent, or `watch` breaks off.
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
        // Intervals narrow with the root of the number of starts.
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

/// The first starts of a series.
fn first(series: usize) -> impl Iterator<Item = SeriesRun> {
    (0..FIRST).map(move |start| SeriesRun { series, start })
}

/// The width to come to where none is asked for, rounded to a digit.
fn width(runs: &Runs, quantity: usize) -> f64 {
    let values: Vec<f64> = (0..FIRST).filter_map(|start| runs.value(0, start, quantity)).collect();
    let mean = mean(&values);
    let spread = mean.spread();
    let rough = PART * mean.mean.abs().max(if spread.is_finite() { spread } else { 0.0 });
    format!("{rough:.0e}").parse().unwrap_or(rough)
}

/// First starts of series that fit into what is left of the time, the cheapest first. What a run costs under a dear law is
/// known to a factor of ten before one was measured, so that a series has one run at first, and the others if they fit.
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

/// More starts for the series with the widest interval that is affordable; none where all are narrow, or none is.
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
        // Intervals narrow with the root of the number of starts; at most as many again, as scatter is not known well.
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

/// Computes runs on all cores, the longest first, and puts each in its place.
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
        // The second quantity has a value in the variant alone, as the energy of bonds has under range.
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
