//! Computes error budgets: estimates how much of a simulated result is due to the grains, to the contact law and to the
//! numerical method.
//!
//! Each possible cause is tested by one change of the scene, from the same initial states as the unchanged scene. The
//! effect of the change is the mean of paired differences, with a confidence interval. The intervals of an error budget
//! are simultaneous: in 95 % of error budgets all of them contain their true values.

mod answer;
mod causes;
mod collect;
mod quantity;
mod report;
mod rows;
mod starts;
mod words;

use std::collections::{HashMap, HashSet};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use serde::Serialize;

use self::answer::budget_of;
pub(crate) use self::causes::{Cause, Variant, short, variants};
use self::collect::{BudgetEnd, Limits, Ran, SeriesRun, collect};
pub(crate) use self::quantity::{BudgetQuantity, Window, measures_of_moment};
pub use self::rows::{BudgetAnswer, BudgetEffect, FEW_UNSOLVED, Trust};
use self::rows::{Design, QuantityBudget};
use self::starts::said_of;
pub(crate) use self::starts::{RunValues, Starts, run};
use crate::config::{Config, joined};
use crate::error::{self, Error, Result};
use crate::harness::{FinishedCase, Journal, Runner, Shard, journal};
use crate::output::{check_writable, note_line, print_line, print_text, remove_drafts};
use crate::scene::Scene;
use crate::sim::Settings;

/// Options of an error budget, which estimates how much of a result is due to the grains, the contact law and the
/// numerical method.
#[derive(Clone, Debug)]
pub struct BudgetOptions {
    /// Scene whose results are examined, with its settings.
    pub config: Config,
    /// Quantities to examine: columns of the tables `steps` and `measures`, or `mean(…)`, `min(…)`, `max(…)`,
    /// `total(…)` of such a column over an interval of simulated time. The slump is examined if the list is empty.
    pub quantities: Vec<String>,
    /// Simulated time from which on results are examined, s; `None` for 0.
    pub from_secs: Option<f64>,
    /// Simulated time up to which results are examined, s; `None` for the end of the run.
    pub to_secs: Option<f64>,
    /// Requested half-width of every confidence interval, in the unit of the examined quantity; `None` for a tenth of
    /// the quantity's value.
    pub within: Option<f64>,
    /// Limit of the total computing time of all runs, divided by the number of threads, s. This is the wall-clock time
    /// if no thread waits.
    pub cost_secs: f64,
    /// The part of the initial states that this call runs, if several machines share the error budget; `None` for all
    /// initial states.
    pub shard: Option<Shard>,
}

/// The error budgets of some quantities of a scene: estimates of how much of each quantity is due to the grains, the
/// contact law and the numerical method.
#[derive(Debug, Serialize)]
pub struct ErrorBudget {
    program: &'static str,
    version: &'static str,
    /// Command that computes the error budget again, without the option that limits the computing time.
    command: String,
    scene: String,
    /// Short description of the scene's stepper, Bond number, time step, restitution and friction.
    stepped: String,
    from_secs: f64,
    to_secs: f64,
    ended: BudgetEnd,
    /// All settings of the scene. Its grains are not included.
    config: Config,
    quantities: Vec<QuantityBudget>,
}

impl ErrorBudget {
    /// Returns the error budget of the first examined quantity, in the form that the graphical window displays.
    pub fn first_answer(&self) -> Option<BudgetAnswer> {
        self.quantities.first().map(QuantityBudget::for_window)
    }

    /// Returns the error budget as JSON, as in the file `budget.json`.
    ///
    /// # Errors If the error budget cannot be written as JSON.
    pub fn to_json(&self) -> Result<String> {
        serde_json::to_string_pretty(self).map_err(|error| Error::file("budget.json", error))
    }
}

/// Name of the journal of an error budget: the file that stores the results of finished runs.
const JOURNAL: &str = "budget";
/// Name of the quantity that is examined if the user gives none.
const QUANTITY: &str = "slump";

/// Computes an error budget and writes `report.md`, pictures, `budget.csv` and `budget.json` to `folder`. If the
/// computation is stopped, a call with the same arguments resumes it. If `options.shard` is set, several calls, for
/// example on several machines, share the error budget: this call only computes its part of the runs, stores them in
/// the folder, and writes no report. Runs of the other calls that are already in the folder do not count towards the
/// time limit of this call.
///
/// # Errors
/// If a quantity, time or setting is not allowed, or if the folder cannot be written; the error names the cause. Also
/// fails if a pile does not come to rest.
pub fn budget(options: &BudgetOptions, folder: &Path) -> Result<ErrorBudget> {
    let go_on = |_: &ErrorBudget| ControlFlow::Continue(());
    let budget = made_showing(true, options, folder, &folder.join("states"), go_on)?;
    if options.shard.is_some() {
        print_line(format_args!("a part of the budget in {}", folder.display()));
        return Ok(budget);
    }
    report::write(&budget, folder)?;
    [folder, &folder.join("states")].into_iter().try_for_each(remove_drafts)?;
    for one in &budget.quantities {
        print_text(format!("{}\n\n", one.answer));
        print_text(report::table(one).to_markdown());
    }
    print_line(folder.join(report::REPORT).display());
    Ok(budget)
}

/// Computes an error budget like [`budget`], but writes no report and no pictures, only the files that are needed to
/// resume, and shows no progress bar. Initial states of piles are stored in the folder `states`. After each group of
/// runs, `watch` is called with the error budget so far. The computation ends if `watch` returns `Break`.
///
/// # Errors
/// Returns the errors of [`budget`].
pub fn made(
    options: &BudgetOptions,
    folder: &Path,
    states: &Path,
    watch: impl FnMut(&ErrorBudget) -> ControlFlow<()>,
) -> Result<ErrorBudget> {
    made_showing(false, options, folder, states, watch)
}

fn made_showing(
    shows_progress: bool,
    options: &BudgetOptions,
    folder: &Path,
    states: &Path,
    mut watch: impl FnMut(&ErrorBudget) -> ControlFlow<()>,
) -> Result<ErrorBudget> {
    let BudgetOptions { config, quantities, within, cost_secs, .. } = options;
    let asked = if quantities.is_empty() { &[QUANTITY.to_owned()] } else { &quantities[..] };
    let quantities: Vec<BudgetQuantity> =
        asked.iter().map(|text| text.parse()).collect::<Result<_>>()?;
    error::check(*cost_secs > 0.0, "cost", format!("{cost_secs} s"), "a time > 0")?;
    let is_size = within.is_none_or(|within| within > 0.0 && within.is_finite());
    error::check(is_size, "within", within.unwrap_or(0.0), "a finite number > 0")?;
    check_writable("out", folder)?;
    let starts = Starts::of(config, states)?;
    let window = window_of(options, &starts)?;
    let variants = variants(&starts.scene, starts.pile.as_ref(), starts.resizes());
    let (runner, others) = runner_of(options.shard, folder)?;
    let key = |start, variant| starts.key(start, variant, &quantities, window);
    let ran = |key: &str, scene: &dyn Fn() -> Result<Scene>| -> Result<Ran> {
        let finished = runner.result(key, || run(&scene()?, &quantities, window))?;
        let is_free = others.contains(key);
        Ok(Ran { values: finished.result, secs: finished.wall_secs, is_free })
    };
    let itself = match starts.pile {
        Some(_) if options.shard.is_none() => Some(ran(&key(None, None)?, &|| starts.itself())?),
        _ => None,
    };
    // Each part of a budget has its own initial states, so parts on different machines need not communicate.
    let (part, parts) = options.shard.map_or((1, 1), |shard| (shard.index, shard.count));
    let of_job = |SeriesRun { series, start }: SeriesRun| {
        let variant = series.checked_sub(1).map(|one| &variants[one]);
        ((start * parts + part) as u64, variant)
    };
    let compute = |job: SeriesRun| {
        let (start, variant) = of_job(job);
        ran(&key(Some(start), variant)?, &|| starts.scene(start, variant))
    };
    let is_free = |job: SeriesRun| -> Result<bool> {
        let (start, variant) = of_job(job);
        Ok(!others.is_empty() && others.contains(&key(Some(start), variant)?))
    };
    let costs = [1.0].into_iter().chain(variants.iter().map(|variant| variant.cost)).collect();
    let cost_secs = cost_secs * rayon::current_num_threads() as f64;
    let limits = Limits { cost_secs, within: *within, parts, shows_progress };
    let settings = starts.scene.settings();
    let design = Design {
        variants: &variants,
        has_seeds: starts.pile.is_some(),
        time_step_secs: settings.parameters.time_step_secs,
    };
    let command = command_of(options, &settings)?;
    let of = |runs: &collect::Runs, ended: BudgetEnd| {
        let of_quantity = |(number, quantity): (usize, &BudgetQuantity)| {
            let itself = itself.as_ref().filter(|ran| ran.values.failure.is_none());
            let itself = itself.and_then(|ran| ran.values.values[number]);
            budget_of(runs, ended, &design, (number, quantity), itself)
        };
        ErrorBudget {
            program: "slump",
            version: env!("CARGO_PKG_VERSION"),
            command: command.clone(),
            scene: starts.scene.name.clone(),
            stepped: said_of(&settings),
            from_secs: window.from_secs,
            to_secs: window.to_secs,
            ended,
            config: config.resolved(&starts.scene),
            quantities: quantities.iter().enumerate().map(of_quantity).collect(),
        }
    };
    let (runs, ended) =
        collect(costs, quantities.len(), limits, (&compute, &is_free), &mut |runs| {
            watch(&of(runs, BudgetEnd::Stopped))
        })?;
    Ok(of(&runs, ended))
}

/// Returns a runner, which computes the runs of an error budget and does not repeat the finished runs in `folder`. Also
/// returns the keys (unique names) of those finished runs that other calls computed, if several calls, for example on
/// several machines, share the error budget. `shard` is the part of this call.
fn runner_of(shard: Option<Shard>, folder: &Path) -> Result<(Runner<RunValues>, HashSet<String>)> {
    let name = shard.map_or_else(|| JOURNAL.to_owned(), |shard| shard.journal(JOURNAL));
    let journal = Journal::open(folder, &name)?;
    let own = journal::path_of(folder, &name);
    let (mut finished, mut others) = (HashMap::new(), HashSet::new());
    let mut paths = journal::journals(&[folder.to_owned()])?;
    // The folder can contain other journals, which do not belong to a budget.
    let is_of_a_part = |path: &PathBuf| {
        let name = path.file_stem().and_then(|name| name.to_str());
        name.is_some_and(|name| name.starts_with(JOURNAL))
    };
    paths.retain(is_of_a_part);
    // The journal of this part is read last, so that a run in two journals counts as a run of this part.
    paths.sort_by_key(|path| *path == own);
    for path in paths {
        for case in journal::read::<FinishedCase<RunValues>>(&path)? {
            if path == own {
                others.remove(&case.key);
            } else {
                others.insert(case.key.clone());
            }
            finished.insert(case.key.clone(), case);
        }
    }
    if !finished.is_empty() {
        note_line(format_args!("{JOURNAL}: {} runs were there", finished.len()));
    }
    Ok((Runner::new(JOURNAL, journal, finished), others))
}

fn command_of(options: &BudgetOptions, settings: &Settings) -> Result<String> {
    let mut words = vec!["slump".to_owned(), "budget".to_owned()];
    words.extend(options.config.words(settings)?);
    words.extend(options.quantities.iter().flat_map(|one| ["--quantity".to_owned(), one.clone()]));
    let BudgetOptions { from_secs, to_secs, within, .. } = *options;
    let numbers = [("--from", from_secs), ("--to", to_secs), ("--within", within)];
    for (name, number) in numbers {
        words.extend(number.into_iter().flat_map(|number| [name.to_owned(), number.to_string()]));
    }
    Ok(joined(&words))
}

fn window_of(options: &BudgetOptions, starts: &Starts) -> Result<Window> {
    let duration_secs = starts.scene.duration_secs;
    let from_secs = options.from_secs.unwrap_or(0.0);
    let to_secs = options.to_secs.unwrap_or(duration_secs);
    let allowed = format!("at least 0 and below the duration of {duration_secs} s");
    error::check(from_secs >= 0.0 && from_secs < duration_secs, "from", from_secs, allowed)?;
    let allowed = format!("above {from_secs} s and at most the duration of {duration_secs} s");
    error::check(to_secs > from_secs && to_secs <= duration_secs, "to", to_secs, allowed)?;
    let step = starts.scene.parameters.time_step_secs;
    let allowed = format!("at least a time step of {step} s after from");
    error::check(to_secs - from_secs >= 0.5 * step, "to", to_secs, allowed)?;
    Ok(Window { from_secs, to_secs })
}
