//! Calibrates a scene: finds the parameters with which the scene reproduces measured values. The parameter values of
//! the runs fill the ranges of the varied parameters evenly, and each run has its own initial state. Polynomials fitted
//! to the results of these runs give a confidence region of the parameters.

mod asked;
mod region;
mod report;
mod surrogate;

use std::path::Path;

use self::asked::{Target, Varied, check_distinct};
pub use self::region::Region;
use self::region::point_of_box;
use self::report::Found;
use self::surrogate::coefficients;
use crate::budget::{
    BudgetQuantity, Cause, RunValues, Starts, Variant, Window, measures_of_moment, run, variants,
};
use crate::config::{Config, joined};
use crate::error::{self, Error, Result};
use crate::harness::{Case, FinishedCase, Runner, Threads};
use crate::output::{check_writable, print_line, print_text, remove_drafts};
use crate::setting::Value;
use crate::statistics::mean;

/// Name of the journal of a calibration: the file that stores the results of finished runs.
const JOURNAL: &str = "calibrate";
/// Default number of runs of a calibration, divided by the number of coefficients of a cubic polynomial in the varied
/// parameters. It is above 6, the ratio from which on the polynomials that predict the results are cubic.
const RUNS_PER_COEFFICIENT: usize = 10;
/// Largest allowed number of varied parameters, and largest allowed number of runs. Larger numbers are probably a
/// mistake.
const MOST: [usize; 2] = [4, 100_000];
/// Number of initial states from which the calibrated scene is run with and without a change of the time step or the
/// solver, to measure the effect of the change. More initial states take more time and give a narrower confidence
/// interval of the effect.
const PAIRS: usize = 6;

/// Options of a calibration, which finds the parameters with which a scene reproduces measured values.
#[derive(Clone, Debug)]
pub struct CalibrateOptions {
    /// Scene to calibrate, with its settings. Its seed, 1 by default, gives the initial state of the first run. Further
    /// runs use the following seeds.
    pub config: Config,
    /// Measured values, as in `slump=0.35±0.02`: a quantity at the end of a run, its value, and its standard error.
    pub targets: Vec<String>,
    /// Parameters to vary, with their ranges, as in `bond=0..50`.
    pub vary: Vec<String>,
    /// Number of runs; `None` for ten runs per coefficient of a cubic polynomial in the parameters.
    pub runs: Option<usize>,
}

/// Setup of one run: the initial states of the scene, the number of the initial state of this run, a change of the
/// numerical method (if any), and the interval of simulated time in which results are evaluated.
type Setup = (Starts, u64, Option<Variant>, Window);

/// Calibrates a scene, and writes `report.md` and a picture of the confidence region to `folder`. A call with the same
/// arguments resumes a calibration that was stopped. A call for more runs adds to the runs in the folder.
///
/// # Errors
/// If a target, parameter or setting is not allowed, or if the folder cannot be written; the error names the cause.
/// Also fails if a pile does not come to rest, or if too few runs give a result.
pub fn calibrate(options: &CalibrateOptions, folder: &Path) -> Result<Region> {
    let targets: Vec<Target> =
        options.targets.iter().map(|it| it.parse()).collect::<Result<_>>()?;
    let vary: Vec<Varied> = options.vary.iter().map(|it| it.parse()).collect::<Result<_>>()?;
    let names: Vec<_> = targets.iter().map(|target| &target.quantity.name).collect();
    check_distinct("target", &names)?;
    check_distinct("vary", &vary.iter().map(|varied| &varied.name).collect::<Vec<_>>())?;
    let allowed = format!("{} parameters at most", MOST[0]);
    error::check(vary.len() <= MOST[0], "vary", vary.len(), allowed)?;
    // Each target takes one degree of freedom from the residuals of the fit, so more targets need more runs.
    let terms = coefficients(vary.len(), 2);
    let least = terms + terms.max(targets.len());
    let count = options.runs.unwrap_or(RUNS_PER_COEFFICIENT * coefficients(vary.len(), 3));
    let allowed = format!("between {least} and {}", MOST[1]);
    error::check((least..=MOST[1]).contains(&count), "runs", count, allowed)?;
    let settings = options.config.without_settling()?.settings();
    let mut config = options.config.clone();
    // The seed is taken out of the settings. The key of a run contains the number of its initial state instead, so that
    // calibrations with different first seeds share runs.
    let first = config.source.seed.take().unwrap_or(1);
    error::check(first <= u64::from(u32::MAX), "seed", first, "at most 4294967295")?;
    let with = |point: &[f64]| {
        let mut config = config.clone();
        for (varied, value) in vary.iter().zip(point) {
            config.set(&varied.name, Value::Number(*value));
        }
        config
    };
    let space: Vec<[f64; 2]> = vary.iter().map(|varied| varied.range).collect();
    for end in [0, 1] {
        let corner: Vec<f64> = space.iter().map(|range| range[end]).collect();
        with(&corner).without_settling()?;
    }
    check_writable("out", folder)?;

    // The runs also record all quantities that are not targets. They cost no further runs, and the report names those
    // whose measurement would narrow the region most.
    let is_other = |name: &&str| targets.iter().all(|target| target.quantity.name != *name);
    let mut quantities: Vec<BudgetQuantity> =
        targets.iter().map(|target| target.quantity.clone()).collect();
    for name in measures_of_moment().filter(is_other) {
        quantities.push(name.parse()?);
    }
    let states = folder.join("states");
    let case = |point: &[f64], start: u64, change: Option<usize>| -> Result<Case<Setup>> {
        let starts = Starts::of(&with(point), &states)?;
        let variant = change.map(|change| methods(&starts).swap_remove(change));
        let window = Window { from_secs: 0.0, to_secs: starts.scene.duration_secs };
        let key = starts.key(Some(start), variant.as_ref(), &quantities, window)?;
        Ok(Case { key, cost: 1.0, setup: (starts, start, variant, window) })
    };
    let compute = |cases: Vec<Case<Setup>>| -> Result<Vec<FinishedCase<RunValues>>> {
        let runner = Runner::<RunValues>::open(JOURNAL, folder, JOURNAL)?;
        runner.run(&cases, Threads::All, |(starts, start, variant, window)| {
            run(&starts.scene(*start, variant.as_ref())?, &quantities, *window)
        })
    };
    let all: Vec<Vec<f64>> = (0..count).map(|number| point_of_box(&space, number)).collect();
    let cases = all.iter().zip(first..).map(|(point, start)| case(point, start, None));
    let finished = compute(cases.collect::<Result<_>>()?)?;
    let gave_targets = |run: &RunValues| {
        run.failure.is_none() && run.values[..targets.len()].iter().all(Option::is_some)
    };
    let all = all.into_iter().zip(finished).filter(|(_, run)| gave_targets(&run.result));
    let (points, runs): (Vec<_>, Vec<_>) =
        all.map(|(point, run)| (point, run.result.values)).unzip();
    // A quantity that is missing in some runs gets no polynomial.
    let whole: Vec<usize> = (0..quantities.len())
        .filter(|&number| runs.iter().all(|values| values[number].is_some()))
        .collect();
    let result = |values: &Vec<Option<f64>>| whole.iter().filter_map(|&it| values[it]).collect();
    let results: Vec<Vec<f64>> = runs.iter().map(result).collect();
    let ends: Vec<[f64; 2]> = targets.iter().map(|target| [target.value, target.error]).collect();
    let region = Region::new(&space, &ends, &points, &results).ok_or_else(|| {
        let allowed = format!("at least {least} that give all targets");
        Error::value("runs", points.len(), allowed)
    })?;

    let best = region.best();
    let changes = methods(&Starts::of(&with(best), &states)?);
    let mut cases = Vec::new();
    for change in std::iter::once(None).chain((0..changes.len()).map(Some)) {
        for start in (first + count as u64..).take(PAIRS) {
            cases.push(case(best, start, change)?);
        }
    }
    let finished = compute(cases)?;
    let mut effects = Vec::new();
    for (number, target) in targets.iter().enumerate() {
        for (variant, changed) in changes.iter().zip(finished.chunks(PAIRS).skip(1)) {
            let value = |run: &FinishedCase<RunValues>| run.result.values[number];
            let difference = |(before, after)| Some(value(after)? - value(before)?);
            let pairs: Vec<f64> = finished.iter().zip(changed).filter_map(difference).collect();
            effects.push((target.quantity.name.clone(), variant.label.clone(), mean(&pairs)));
        }
    }
    let mut command = vec!["slump".to_owned(), JOURNAL.to_owned()];
    command.extend(options.config.words(&settings)?);
    for (name, all) in [("--target", &options.targets), ("--vary", &options.vary)] {
        command.extend(all.iter().flat_map(|text| [name.to_owned(), text.clone()]));
    }
    command.extend(options.runs.iter().flat_map(|runs| ["--runs".to_owned(), runs.to_string()]));
    let others: Vec<&BudgetQuantity> = whole.iter().map(|&number| &quantities[number]).collect();
    let command = joined(&command);
    let found = Found {
        command,
        targets: &targets,
        vary: &vary,
        points: &points,
        count,
        region: &region,
        effects,
        quantities: &others,
    };
    print_text(report::write(&found, folder)?);
    [folder, &*states].into_iter().try_for_each(remove_drafts)?;
    print_line(folder.join(report::REPORT).display());
    Ok(region)
}

/// Returns the changes of the numerical method whose effects are reported: steps that are solved to a smaller
/// tolerance, and half the time step.
fn methods(starts: &Starts) -> Vec<Variant> {
    let all = variants(&starts.scene, None, false);
    let first = |cause| all.iter().find(|variant| variant.cause == cause).cloned();
    [Cause::Unsolved, Cause::TimeStep].into_iter().filter_map(first).collect()
}
