//! Charts the accuracy of solver methods in single steps against their computing time. The error is the distance of the
//! velocities from a solution under Coulomb friction.

use serde::{Deserialize, Serialize};

use super::collection::{CollectionPlan, over_steps};
use super::performance::{Timing, geometric_mean, share_solved, speed_ratio};
use super::solves::{
    LEAST_REPEATS, LONG_SOLVE_SECS, ReferenceSearch, References, SolveTimer, TimedSolve,
    TimedSolves,
};
use super::variants::{self, Family};
use super::{Bench, ChartSection};
use crate::chart::{Axis, Chart, Layer, Look, MapCell, Rgb, Sheet, pareto_front, points};
use crate::error::Result;
use crate::harness::{Change, Effort, ReportTable, Threads};
use crate::solver::{FrictionModel, Method, Ordering, SolutionSearch, worst};
use crate::world::RESTITUTION_THRESHOLD;

/// Errors of the velocities, in units of √(g d), with gravity g and mean diameter d. The report says how long each
/// solver method takes to reach each of these errors.
const REPORTED: [f64; 3] = [1e-2, 1e-3, 1e-4];
const BASE: (Method, Ordering) = (Method::Nsgs, Ordering::Interleaved);
const SIZES: [usize; 4] = [138, 500, 2_000, 10_000];
/// Smallest error of the velocities that the chart shows, in units of √(g d), with gravity g and mean diameter d.
const LEAST_ERROR: f64 = 1e-8;
const BAND: Rgb = (225, 225, 225);

/// Settings of the search for the solutions of a step, from which errors of solver methods are measured. More initial
/// guesses (`starts`) find more solutions.
const SEARCH: SolutionSearch =
    SolutionSearch { starts: 4, seed: 1, max_sweeps: 30_000, tolerance: 1e-12 };

/// The results of all solver variants on one step, and the known solutions of the step.
#[derive(Clone, Serialize, Deserialize)]
struct TimedStep {
    references: References,
    solves: Vec<TimedSolves>,
}

/// The results of all solver variants on a collection of steps.
struct TimedCollection {
    title: String,
    /// Computing time of a solve above which the step is not solved again with more sweeps, s.
    limit_secs: f64,
    problems: Vec<String>,
    variants: Vec<Change>,
    steps: Vec<TimedStep>,
}

/// Measures the time and the error of all solver variants on steps of piles of 138 grains (the number in Abramian &
/// Staron 2020), and charts the results.
pub(super) fn make(bench: &Bench) -> Result<Vec<ChartSection>> {
    let effort = bench.effort;
    let timer =
        CollectionTimer { variants: with_bounds(variants::of_problems(effort == Effort::Full)) };
    let limit_secs = effort.pick(0.02, 0.2);
    let mut all = Vec::new();
    for (label, threshold, title) in [
        ("steps", RESTITUTION_THRESHOLD, "steps, restitution from 2 g·Δt up"),
        ("steps-paper", 0.0, "steps, restitution as in the paper"),
    ] {
        all.push(timer.time(
            bench,
            label,
            &CollectionPlan::piles(threshold, effort),
            title,
            limit_secs,
        )?);
    }
    Ok(vec![timer.section(bench, "chart-step", &all)])
}

/// Measures the time and the error of all solver variants on steps of piles with 138 grains (the number in Abramian &
/// Staron 2020) to 10,000 grains, and charts the results. The piles begin to slump, or are at rest in a box.
pub(super) fn make_sizes(bench: &Bench) -> Result<Vec<ChartSection>> {
    let effort = bench.effort;
    let timer = CollectionTimer { variants: with_bounds(variants::of_problems(false)) };
    let mut sections = Vec::new();
    for (name, in_a_box, state) in
        [("chart-size-moving", false, "that begin to slump"), ("chart-size-rest", true, "at rest")]
    {
        let mut all = Vec::new();
        for grains in SIZES {
            let plan = CollectionPlan::of_size(grains, in_a_box, effort);
            let limit_secs = effort.pick(1e-4, 5e-4) * grains as f64;
            let title = format!("steps of {grains} grains {state}");
            all.push(timer.time(bench, "sizes", &plan, &title, limit_secs)?);
        }
        sections.push(timer.section(bench, name, &all));
    }
    Ok(sections)
}

/// Adds two solver variants to a list. Both solve bounded friction (Tresca) instead of Coulomb friction, one by sweeps
/// and one by the interior-point method.
fn with_bounds(mut variants: Vec<Change>) -> Vec<Change> {
    let models = variants::models().into_iter();
    variants.extend(models.filter(|one| one.solver().friction_model == FrictionModel::Tresca));
    variants
}

struct CollectionTimer {
    variants: Vec<Change>,
}

impl CollectionTimer {
    /// Measures the time and the error of every solver variant on every step of a collection, one after the other.
    /// Results are stored in the journal (file of results) named `journal`, and steps whose results are already in this
    /// file are not measured again.
    fn time(
        &self,
        bench: &Bench,
        journal: &str,
        plan: &CollectionPlan,
        title: &str,
        limit_secs: f64,
    ) -> Result<TimedCollection> {
        let steps = over_steps(bench, journal, plan, Threads::One, |step| {
            let references = step.next_problem(ReferenceSearch(SEARCH));
            let timers = self.variants.iter();
            let timers =
                timers.map(|variant| SolveTimer { variant, references: &references, limit_secs });
            let solves = timers.map(|timer| timer.time(step)).collect::<Result<_>>()?;
            Ok(TimedStep { references, solves })
        })?;
        let problems = plan.names();
        Ok(TimedCollection {
            title: format!("{} {title}", problems.len()),
            limit_secs,
            problems,
            variants: self.variants.clone(),
            steps,
        })
    }

    fn section(&self, bench: &Bench, name: &str, all: &[TimedCollection]) -> ChartSection {
        ChartSection {
            name: name.to_owned(),
            sheet: errors_sheet(bench, all),
            words: words(all),
            tables: vec![reported(name, all), summary(name, all), efforts(name, all)],
        }
    }
}

impl TimedCollection {
    fn timings(&self, variant: usize, error: f64) -> Vec<Timing> {
        self.steps.iter().map(|step| step.solves[variant].timing(error)).collect()
    }

    /// Returns the median over all steps of the value that `number` computes from the known solutions of a step.
    fn of_references(&self, number: fn(&References) -> f64) -> f64 {
        median(self.steps.iter().map(|step| number(&step.references)).collect())
    }

    /// Returns, for each number of sweeps of a solver variant, the median time of a solve, ms, and the median error of
    /// the velocities, in √(g d) with gravity g and mean diameter d, over all steps.
    fn medians(&self, variant: usize) -> Vec<(f64, f64)> {
        let solves = || self.steps.iter().map(|step| &step.solves[variant]);
        let longest = solves().map(|solves| solves.0.len()).max().unwrap_or(0);
        let point = |number: usize| {
            let efforts: Vec<_> = solves().filter_map(|solves| solves.effort(number)).collect();
            let secs = efforts.iter().map(|effort| effort.secs).collect();
            let errors = efforts.iter().map(|effort| effort.error).collect();
            (1e3 * median(secs), median(errors).max(LEAST_ERROR))
        };
        (0..longest).map(point).collect()
    }

    /// Returns the best results of a family of methods (a group of similar solver methods) as points (median time, ms;
    /// median error), by increasing time. A result is one of the best if no other result of the family is at least as
    /// fast and at least as accurate.
    fn front(&self, family: Family) -> Vec<(f64, f64)> {
        let its = (0..self.variants.len()).filter(|&one| self.variants[one].family() == family);
        let all: Vec<(f64, f64)> = its.flat_map(|one| self.medians(one)).collect();
        let by_speed: Vec<_> = all.iter().map(|(time, error)| (1.0 / time, *error)).collect();
        pareto_front(&by_speed).into_iter().rev().map(|index| all[index]).collect()
    }
}

/// Returns the median of the values: for an even number of values the larger of the two middle values; 0 if there are
/// no values.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

fn errors_sheet(bench: &Bench, all: &[TimedCollection]) -> Sheet {
    let mut charts = Vec::new();
    for timed in all {
        let curves = Family::ALL.map(|family| (family, timed.front(family)));
        let times = || curves.iter().flat_map(|(_, curve)| curve).map(|(time, _)| *time);
        let least = times().fold(f64::INFINITY, f64::min).min(1.0);
        let most = times().fold(0.0, f64::max).max(10.0 * least);
        let mut chart = Chart::new(
            timed.title.clone(),
            Axis::log("time of a step (ms)", 0.7 * least, 1.5 * most),
            Axis::log("error against Coulomb's law, √(g d)", 0.5 * LEAST_ERROR, 3.0),
        );
        let floor = timed.of_references(References::floor);
        if floor > LEAST_ERROR {
            let (x, y) = ([chart.x.from, chart.x.to], [chart.y.from, floor]);
            let cell = MapCell { x: (x[0], x), y: (floor, y), value: floor };
            let name = "not told apart".to_owned();
            chart.layers.push(Layer::Cells { name, cells: vec![cell], colour: |_| BAND });
        }
        for (family, curve) in curves {
            let look = if family == Family::Default { Look::Dots(7) } else { Look::LineAndDots };
            let (name, curve) = (family.name(), points(curve));
            chart.layers.push(Layer::curve(name, curve, family.colour(), look));
        }
        charts.push(chart);
    }
    let charted = all.iter().take(1).flat_map(|timed| &timed.variants);
    let caption = bench.caption(&[
        "Median error against median time of the best member of each family, with 1, 2, 4, 8 … sweeps or factorisations, \
         warm start. The error is the distance to the nearest solution of Coulomb's law that was found.",
        "Grey: below what tells methods apart, in the median over the steps: the largest distance of two solutions of a step, \
         or how far the solutions that were found are estimated to be from true ones.",
        &variants::members(charted),
    ]);
    Sheet { size: (500 * charts.len().max(2) as u32, 600), charts, caption }
}

/// Returns the text of the report about single steps: how they were timed, and, for each collection of steps, how many
/// steps have several solutions.
fn words(all: &[TimedCollection]) -> String {
    let mut lines = vec![format!(
        "Errors are distances of velocities to the nearest of the solutions that {} starts led to, in √(g d). Times are \
         minima of at least {LEAST_REPEATS} repeats, except for solves of more than {LONG_SOLVE_SECS} s; means geometric. \
         Where nsgs gave up, the time that it took until then stands for the time that it would need, and the ratio is a \
         lower bound.\n",
        SEARCH.starts
    )];
    for timed in all {
        let several = timed.steps.iter().filter(|step| step.references.found > 1).count();
        let largest = |number: fn(&References) -> f64| {
            let all = timed.steps.iter().map(|step| number(&step.references));
            all.fold(0.0, f64::max)
        };
        lines.push(format!(
            "* {}, with up to some {:.2} s a solve: {several} with several solutions, {:.0e} apart at most; those found are \
             estimated to be within {:.0e} of true ones in the median and {:.0e} at most.",
            timed.title,
            timed.limit_secs,
            largest(|references| references.spread),
            timed.of_references(|references| references.told),
            largest(|references| references.told),
        ));
    }
    lines.join("\n")
}

/// Returns a table with one row per collection of steps: the error of the default solver beside the error that a run
/// reports for it, as medians and largest values over the steps, and in how many steps the reported error is too small.
fn reported(name: &str, all: &[TimedCollection]) -> ReportTable {
    let columns = "collection median_error median_reported largest_error largest_reported steps_reported_too_small";
    let row = |timed: &TimedCollection| {
        let number = timed.variants.iter().position(Change::is_default);
        let solves = timed.steps.iter().filter_map(|step| step.solves[number?].0.last());
        let of = |value: fn(&TimedSolve) -> f64| solves.clone().map(value).collect::<Vec<f64>>();
        let [errors, reported] = [of(|solve| solve.error), of(|solve| solve.reported)];
        // An error below the error of the known solutions says nothing.
        let floors = timed.steps.iter().map(|step| step.references.told);
        let too_small = errors.iter().zip(&reported).zip(floors);
        let too_small = too_small.filter(|((error, told), floor)| *error > floor && *told < *error);
        let too_small = too_small.count();
        let mut row = vec![timed.title.clone()];
        let largest = |values: &[f64]| values.iter().copied().fold(0.0, worst);
        for number in
            [median(errors.clone()), median(reported.clone()), largest(&errors), largest(&reported)]
        {
            row.push(format!("{number:.1e}"));
        }
        row.push(too_small.to_string());
        row
    };
    ReportTable::new(format!("{name}-reported"), columns, all.iter().map(row))
}

/// Returns a table with one row per collection of steps, error and solver variant: the fraction of the steps in which
/// the variant reaches the error, its mean time to reach it, and its speed relative to Gauss–Seidel.
fn summary(name: &str, all: &[TimedCollection]) -> ReportTable {
    let columns = "collection method error share_reached mean_ms ratio_to_nsgs_at_least";
    let mut rows = Vec::new();
    for timed in all {
        let is_base = |one: &Change| (one.solver().method, one.solver().ordering) == BASE;
        let base = timed.variants.iter().position(is_base).unwrap_or(0);
        for error in REPORTED {
            for (number, variant) in timed.variants.iter().enumerate() {
                let timings = timed.timings(number, error);
                let solved = timings.iter().filter(|timing| timing.solved);
                let mean_ms = geometric_mean(solved.map(|timing| 1e3 * timing.secs));
                let ratio = speed_ratio(&timed.timings(base, error), &timings);
                let mut row = vec![timed.title.clone(), variant.name.clone(), format!("{error:e}")];
                row.push(format!("{:.3}", share_solved(&timings)));
                row.extend(
                    [mean_ms, ratio].map(|x| x.map_or(String::new(), |x| format!("{x:.4}"))),
                );
                rows.push(row);
            }
        }
    }
    ReportTable::new(format!("{name}-ratios"), columns, rows)
}

fn efforts(name: &str, all: &[TimedCollection]) -> ReportTable {
    let columns = "problem solutions spread method sweeps seconds error";
    let mut rows = Vec::new();
    for timed in all {
        for (problem, step) in timed.problems.iter().zip(&timed.steps) {
            for (variant, solves) in timed.variants.iter().zip(&step.solves) {
                rows.extend(solves.0.iter().map(|effort| {
                    vec![
                        problem.clone(),
                        step.references.found.to_string(),
                        format!("{:e}", step.references.spread),
                        variant.name.clone(),
                        effort.sweeps.to_string(),
                        format!("{:e}", effort.secs),
                        format!("{:e}", effort.error),
                    ]
                }));
            }
        }
    }
    ReportTable::new(format!("{name}-efforts"), columns, rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_front_takes_the_best_of_a_family_and_a_solve_that_ended_stays_as_good() {
        let solves = |efforts: &[(f64, f64)]| {
            let effort =
                |&(secs, error): &(f64, f64)| TimedSolve { sweeps: 1, secs, error, reported: 0.0 };
            TimedSolves(efforts.iter().map(effort).collect())
        };
        let variants = vec![variants::of_method(Method::Nsgs), variants::of_method(Method::Jacobi)];
        let references =
            serde_json::from_str(r#"{"found":1,"spread":0.0,"told":0.0,"residual":0.0}"#);
        let references: References = references.expect("references");
        let step = |nsgs: &[(f64, f64)]| TimedStep {
            references: references.clone(),
            solves: vec![solves(nsgs), solves(&[(2e-3, 0.5), (4e-3, 0.01)])],
        };
        let steps = vec![step(&[(1e-3, 0.2), (3e-3, 0.1), (5e-3, 0.0)]), step(&[(1e-3, 0.2)])];
        let timed = TimedCollection {
            title: String::new(),
            limit_secs: 1.0,
            problems: Vec::new(),
            variants,
            steps,
        };
        assert_eq!(timed.medians(0), [(1.0, 0.2), (3.0, 0.2), (5.0, 0.2)]);
        assert_eq!(timed.front(Family::Sweeps), [(1.0, 0.2), (4.0, 0.01)]);
        assert!(timed.front(Family::Newton).is_empty());
    }
}
