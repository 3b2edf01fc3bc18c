//! Every case of every experiment in every way, each result kept as it comes.

use std::collections::HashMap;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::time::Instant;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::experiment::{Case, Cases, Experiment, Found, Measured};
use super::quantity::{Quantity, Verdict};
use super::way::{Choice, Effort, Way};
use crate::error::{Error, Result};
use crate::journal::Journal;
use crate::output::Progress;

/// Lines that tell of progress where there is no terminal to draw a bar on.
const LINES_OF_PROGRESS: usize = 20;

/// A line of the journal.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Entry {
    key: String,
    wall_secs: f64,
    measured: Measured,
}

/// An experiment in one way.
pub(super) struct Ran {
    pub experiment: &'static Experiment,
    /// None where the experiment has methods of its own.
    pub way: Option<Way>,
    pub found: Vec<Found>,
}

impl Ran {
    /// Its way, in words.
    pub(super) fn words(&self) -> String {
        self.way.map_or("methods of its own".to_owned(), |way| way.words())
    }

    /// Why no verdict can be had of it, where none can: what is left of its runs is no fair sample.
    pub(super) fn spoilt(&self) -> Option<String> {
        let blew_up = self.found.iter().filter(|one| one.measured.blew_up).count();
        let lost = self.found.iter().filter(|one| one.measured.lost_grains > 0).count();
        let runs = self.found.len();
        (blew_up + lost > 0).then(|| {
            format!("of {runs} runs {blew_up} were no longer finite and {lost} lost grains")
        })
    }

    /// Its quantities, each with its verdict.
    pub(super) fn judged(&self) -> Vec<(Quantity, Verdict)> {
        let sound: Vec<Found> =
            self.found.iter().filter(|one| !one.measured.blew_up).cloned().collect();
        let is_spoilt = self.spoilt().is_some();
        let judge = |quantity: Quantity| {
            let verdict = if is_spoilt { Verdict::NotDecided } else { quantity.verdict() };
            (quantity, verdict)
        };
        (self.experiment.judge)(&sound).into_iter().map(judge).collect()
    }

    /// Whether all that is asked of a step is a number of sweeps.
    pub(super) fn has_sweeps_alone(&self) -> bool {
        self.way.is_none_or(|way| matches!(way.effort, Effort::Sweeps(_)))
    }

    /// Wall-clock time of all its runs, s.
    pub(super) fn wall_secs(&self) -> f64 {
        self.found.iter().map(|one| one.wall_secs).sum()
    }

    /// Simulated seconds per second.
    pub(super) fn speed(&self) -> f64 {
        let simulated: f64 = self.found.iter().map(|one| one.measured.simulated_secs).sum();
        simulated / self.wall_secs()
    }

    /// Part of its steps that were not solved as asked.
    pub(super) fn unsolved(&self) -> f64 {
        let sum = |number: fn(&Measured) -> u64| {
            self.found.iter().map(|one| number(&one.measured)).sum::<u64>() as f64
        };
        sum(|one| one.unsolved_steps) / sum(|one| one.steps).max(1.0)
    }
}

/// A case that is wanted, and where its result goes.
struct Wanted {
    key: String,
    case: Case,
    /// Number of its experiment and way.
    ran: usize,
}

/// Runs what is not done yet.
///
/// # Errors
/// Where a scene is not sound or the journal cannot be written. A state that is no longer finite is a result.
pub(super) fn run_all(
    experiments: &[&'static Experiment],
    choice: &Choice,
    quick: bool,
    (journal, done): (&Journal, Vec<Entry>),
) -> Result<Vec<Ran>> {
    let (mut all, wanted) = lay_out(experiments, choice, quick);
    let done: HashMap<String, Entry> =
        done.into_iter().map(|entry| (entry.key.clone(), entry)).collect();
    let mut order: Vec<&Wanted> =
        wanted.iter().filter(|wanted| !done.contains_key(&wanted.key)).collect();
    // Longest first, so that no core waits long for the last one.
    order.sort_by(|one, other| other.case.cost.total_cmp(&one.case.cost));
    let fresh = compute(order, journal)?;
    for Wanted { key, case, ran } in wanted {
        let entry = fresh.get(&key).or_else(|| done.get(&key));
        let missing = || Error::value("validate", &key, "computed");
        let Entry { wall_secs, measured, .. } = entry.cloned().ok_or_else(missing)?;
        all[ran].found.push(Found { at: case.at, measured, wall_secs });
    }
    Ok(all)
}

/// All cases, in the order of the report.
fn lay_out(
    experiments: &[&'static Experiment],
    choice: &Choice,
    quick: bool,
) -> (Vec<Ran>, Vec<Wanted>) {
    let (mut all, mut wanted) = (Vec::new(), Vec::new());
    for &experiment in experiments {
        let sets: Vec<(Option<Way>, Vec<Case>)> = match experiment.cases {
            Cases::Own(cases) => vec![(None, cases(quick))],
            Cases::Chosen(cases) => {
                choice.ways().into_iter().map(|way| (Some(way), cases(quick, way))).collect()
            }
        };
        for (way, cases) in sets.into_iter().filter(|(_, cases)| !cases.is_empty()) {
            let ran = Ran { experiment, way, found: Vec::new() };
            let words = ran.words();
            for case in cases {
                let at: Vec<String> =
                    case.at.iter().map(|(name, value)| format!("{name} {value}")).collect();
                let key = format!("{}; {words}; {}", experiment.name, at.join(", "));
                wanted.push(Wanted { key, case, ran: all.len() });
            }
            all.push(ran);
        }
    }
    (all, wanted)
}

fn compute(order: Vec<&Wanted>, journal: &Journal) -> Result<HashMap<String, Entry>> {
    let total = order.len();
    let units = |wanted: &Wanted| wanted.case.cost.ceil() as u64;
    let progress = Progress::new("experiments", order.iter().map(|wanted| units(wanted)).sum());
    let finished = AtomicUsize::new(0);
    let run = |wanted: &Wanted| {
        let started = Instant::now();
        let measured = match (wanted.case.run)() {
            Err(Error::NonFinite { .. }) => Measured { blew_up: true, ..Measured::default() },
            measured => measured?,
        };
        let wall_secs = started.elapsed().as_secs_f64();
        let entry = Entry { key: wanted.key.clone(), wall_secs, measured };
        journal.add(&entry)?;
        progress.advance(units(wanted));
        let count = 1 + finished.fetch_add(1, Relaxed);
        if !progress.is_drawn()
            && count * LINES_OF_PROGRESS / total > (count - 1) * LINES_OF_PROGRESS / total
        {
            progress.say(&format!("validate: {count} of {total} runs"));
        }
        Ok((entry.key.clone(), entry))
    };
    let ended = order.into_par_iter().with_max_len(1).map(run).collect();
    progress.finish();
    ended
}
