//! Runs the cases (runs) of a study or an experiment. The runner computes the cases that are not finished, writes each
//! result to a journal (file of results) as soon as the case ends, and returns all results in the order of the cases.

use std::collections::HashMap;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::time::Instant;

use rayon::prelude::*;
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::case::{Case, FinishedCase};
use super::journal::{self, Journal};
use crate::error::Result;
use crate::output::{Progress, note_line};

/// Number of progress lines that are printed in the course of an experiment if there is no terminal on which to draw a
/// progress bar.
const LINES_OF_PROGRESS: usize = 20;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Threads {
    /// Runs as many cases at a time as there are threads, the longest case first, so that at the end no thread waits
    /// long for the last case.
    All,
    /// Runs one case at a time, so that its computing time is not affected by other cases.
    One,
}

pub(crate) struct Runner<T> {
    name: String,
    journal: Journal,
    finished: HashMap<String, FinishedCase<T>>,
}

impl<T: Clone + Send + Sync + Serialize + DeserializeOwned> Runner<T> {
    /// Opens a runner, which computes the cases (runs) of an experiment and appends each result to the journal
    /// `journal_name` in `folder`, a file with one line per finished case. Cases whose results are already in the
    /// journal are not computed again. If there are such results, their number is printed.
    pub(crate) fn open(name: &str, folder: &Path, journal_name: &str) -> Result<Self> {
        // Opening the journal cuts off an incomplete last line, so the journal is opened before it is read.
        let journal = Journal::open(folder, journal_name)?;
        let finished = journal::read(&journal::path_of(folder, journal_name))?;
        if !finished.is_empty() {
            note_line(format_args!("{journal_name}: {} measurements were there", finished.len()));
        }
        let by_key = |case: FinishedCase<T>| (case.key.clone(), case);
        Ok(Self::new(name, journal, finished.into_iter().map(by_key).collect()))
    }

    /// Returns a runner, which computes the cases (runs) of an experiment and appends each result to `journal`, a file
    /// with one line per finished case. Cases whose keys (names) are in `finished` are not computed again.
    pub(crate) fn new(
        name: &str,
        journal: Journal,
        finished: HashMap<String, FinishedCase<T>>,
    ) -> Self {
        Self { name: name.to_owned(), journal, finished }
    }

    pub(crate) fn has(&self, key: &str) -> bool {
        self.finished.contains_key(key)
    }

    /// Computes those of `cases` that are not finished, and returns the results of all cases in the order of `cases`.
    pub(crate) fn run<C: Sync>(
        &self,
        cases: &[Case<C>],
        threads: Threads,
        compute: impl Fn(&C) -> Result<T> + Sync,
    ) -> Result<Vec<FinishedCase<T>>> {
        let is_finished = |(_, case): &(usize, &Case<C>)| self.finished.contains_key(&case.key);
        let mut pending: Vec<_> =
            cases.iter().enumerate().filter(|case| !is_finished(case)).collect();
        if threads == Threads::All {
            // The sort is stable, so cases of equal cost keep their order.
            pending.sort_by(|(_, one), (_, other)| other.cost.total_cmp(&one.cost));
        }
        let units = |case: &Case<C>| case.cost.ceil() as u64;
        let progress = Progress::new(&self.name, pending.iter().map(|(_, case)| units(case)).sum());
        let (total, count) = (pending.len(), AtomicUsize::new(0));
        let run_one = |(index, case): (usize, &Case<C>)| {
            let finished = self.result(&case.key, || compute(&case.setup))?;
            progress.advance(units(case));
            let count = 1 + count.fetch_add(1, Relaxed);
            let lines = |count: usize| count * LINES_OF_PROGRESS / total;
            if !progress.is_drawn() && lines(count) > lines(count - 1) {
                progress.say(&format!("{}: {count} of {total} runs", self.name));
            }
            Ok((index, finished))
        };
        let computed: Result<Vec<_>> = match threads {
            Threads::All => pending.into_iter().par_bridge().map(run_one).collect(),
            Threads::One => pending.into_iter().map(run_one).collect(),
        };
        progress.finish();
        let mut results: Vec<_> =
            cases.iter().map(|case| self.finished.get(&case.key).cloned()).collect();
        for (index, finished) in computed? {
            results[index] = Some(finished);
        }
        Ok(results.into_iter().flatten().collect())
    }

    /// Returns the result of the case (run of an experiment) with the name `key`. If the case is finished, the result
    /// is already known. Otherwise `compute` computes the result, which is then appended to the journal, the file of
    /// results. This function is for a case that depends on the results of other cases.
    pub(crate) fn result(
        &self,
        key: &str,
        compute: impl FnOnce() -> Result<T>,
    ) -> Result<FinishedCase<T>> {
        if let Some(finished) = self.finished.get(key) {
            return Ok(finished.clone());
        }
        let started = Instant::now();
        let result = compute()?;
        let wall_secs = started.elapsed().as_secs_f64();
        let finished = FinishedCase { key: key.to_owned(), wall_secs, result };
        self.journal.add(&finished)?;
        Ok(finished)
    }
}

#[cfg(test)]
mod tests {
    use serde::Deserialize;

    use super::*;
    use crate::error::Error;

    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    struct Square {
        square: f64,
    }

    fn cases() -> Vec<Case<f64>> {
        let case = |number: i32| Case {
            key: format!("case {number}"),
            cost: f64::from(number % 3),
            setup: f64::from(number),
        };
        (0..7).map(case).collect()
    }

    #[test]
    fn finished_cases_are_not_run_again_and_results_have_the_order_of_the_cases() {
        let folder = tempfile::tempdir().unwrap();
        let runner = || Runner::<Square>::open("squares", folder.path(), "squares").unwrap();
        let squares = |finished: Vec<FinishedCase<Square>>| -> Vec<f64> {
            finished.into_iter().map(|case| case.result.square).collect()
        };
        for threads in [Threads::One, Threads::All] {
            std::fs::remove_file(journal::path_of(folder.path(), "squares")).ok();
            let fails = |number: &f64| match *number {
                4.0 => Err(Error::value("number", 4, "another")),
                number => Ok(Square { square: number * number }),
            };
            assert!(runner().run(&cases(), threads, fails).is_err());
            let kept = runner().finished.len();
            assert!(kept < 7 && (threads == Threads::All || kept == 4), "{kept}");
            let count = AtomicUsize::new(0);
            let computes = |number: &f64| {
                count.fetch_add(1, Relaxed);
                Ok(Square { square: number * number })
            };
            let whole = runner().run(&cases(), threads, computes).unwrap();
            assert_eq!(squares(whole), [0.0, 1.0, 4.0, 9.0, 16.0, 25.0, 36.0]);
            assert_eq!(count.load(Relaxed), 7 - kept);
        }
    }
}
