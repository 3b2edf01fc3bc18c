//! Speed against accuracy of single steps: residual against time.

use super::collection::{CollectionPlan, collect};
use super::performance::{Timing, geometric_mean, median_with_failures, share_solved, speed_ratio};
use super::solves::{
    LEAST_REPEATS, LONG_SOLVE_SECS, MOST_SWEEPS, ROUNDING, SolveTimer, TimedSolves,
};
use super::variants::{self, ChartedVariant, Family};
use super::{Bench, ChartSection};
use crate::chart::{Axis, Chart, Layer, Look, Sheet, points};
use crate::error::Result;
use crate::report::ReportTable;
use crate::runner::{Case, Runner, Threads};
use crate::solver::{FrictionModel, Method, Ordering};

/// Threshold of restitution with which nearly every step has a solution.
const THRESHOLD: f64 = 2.0;
const REPORTED: [f64; 3] = [1e-3, 1e-6, 1e-8];
const BASE: (Method, Ordering) = (Method::Nsgs, Ordering::Interleaved);
/// A warm start below this residual leaves next to nothing to be told about a method: the pile rests.
const FAR: f64 = 1e-3;
const SIZES: [usize; 3] = [500, 2_000, 10_000];

/// A collection of steps, and what every variant made of it.
#[derive(Clone)]
struct TimedCollection {
    title: String,
    /// Most time of a solve, s.
    limit_secs: f64,
    problems: Vec<String>,
    variants: Vec<ChartedVariant>,
    /// By variant, then by step.
    solves: Vec<Vec<TimedSolves>>,
}

/// Times all variants over steps of 138 grains.
pub(super) fn make(bench: &Bench) -> Result<Vec<ChartSection>> {
    let quick = bench.options.quick;
    let timer = CollectionTimer {
        variants: variants::of_problems(!quick),
        goals: residuals_asked_for(quick),
    };
    let limit_secs = if quick { 0.25 } else { 3.0 };
    let pick = if quick { CollectionPlan::fewer_piles } else { CollectionPlan::piles };
    let mut all = Vec::new();
    for (label, threshold, title) in [
        ("steps", THRESHOLD, "steps, restitution from 2 g·Δt up"),
        ("steps-paper", 0.0, "steps, restitution as in the paper"),
    ] {
        all.push(timer.time(bench, label, &pick(threshold), title, limit_secs)?);
    }
    Ok(vec![timer.section(bench, "chart-step", &all)])
}

/// Times all variants over steps of larger piles, which begin to slump or rest in their box: under Coulomb's law, and
/// under a convex model.
pub(super) fn make_sizes(bench: &Bench) -> Result<Vec<ChartSection>> {
    let quick = bench.options.quick;
    let mut variants = variants::of_problems(false);
    let models = variants::models().into_iter();
    variants.extend(models.filter(|one| one.solver.friction_model == FrictionModel::Tresca));
    let timer = CollectionTimer { variants, goals: REPORTED.to_vec() };
    let mut sections = Vec::new();
    for (name, in_a_box, state) in
        [("chart-size-moving", false, "that begin to slump"), ("chart-size-rest", true, "at rest")]
    {
        let mut all = Vec::new();
        for grains in SIZES {
            let plan = CollectionPlan::of_size(grains, in_a_box, quick);
            let limit_secs = if quick { 1e-4 } else { 1e-3 } * grains as f64;
            let title = format!("steps of {grains} grains {state}");
            all.push(timer.time(bench, "sizes", &plan, &title, limit_secs)?);
        }
        sections.push(timer.section(bench, name, &all));
    }
    Ok(sections)
}

struct CollectionTimer {
    variants: Vec<ChartedVariant>,
    goals: Vec<f64>,
}

impl CollectionTimer {
    /// Times every variant on every step, one after the other, but for what the journal of that name has.
    fn time(
        &self,
        bench: &Bench,
        journal: &str,
        plan: &CollectionPlan,
        title: &str,
        limit_secs: f64,
    ) -> Result<TimedCollection> {
        let Self { variants, goals } = self;
        let runner: Runner<TimedSolves> = bench.runner(journal)?;
        let problems = plan.names();
        let mut cases: Vec<Case<(usize, &ChartedVariant)>> = Vec::new();
        for (step, name) in problems.iter().enumerate() {
            cases.extend(variants.iter().map(|variant| {
                let key = format!("{name}, {}", variant.name);
                Case { key, cost: 1.0, setup: (step, variant) }
            }));
        }
        let is_finished = cases.iter().all(|case| runner.has(&case.key));
        let steps = if is_finished { Vec::new() } else { collect(plan, &bench.states_folder())? };
        let results = runner.run(&cases, Threads::One, |&(step, variant)| {
            SolveTimer { variant, goals, limit_secs }.time(&steps[step])
        })?;
        let mut solves: Vec<Vec<TimedSolves>> = variants.iter().map(|_| Vec::new()).collect();
        for (index, case) in results.into_iter().enumerate() {
            solves[index % variants.len()].push(case.result);
        }
        let title = format!("{} {title}", problems.len());
        Ok(TimedCollection { title, limit_secs, problems, variants: variants.clone(), solves })
    }

    fn section(&self, bench: &Bench, name: &str, all: &[TimedCollection]) -> ChartSection {
        let goals = &self.goals;
        ChartSection {
            name: name.to_owned(),
            sheet: residuals_sheet(bench, all, goals),
            words: words(all),
            summary: summary(name, all),
            others: vec![times(name, all, goals)],
        }
    }
}

/// Residuals by half decades, or, in the quick pass, decades.
fn residuals_asked_for(quick: bool) -> Vec<f64> {
    let per_decade = if quick { 1 } else { 2 };
    // Written out in decimals, so that 1e-3 is 1e-3.
    let residual = |index: i32| {
        let exact = 10f64.powf(-1.0 - f64::from(index) / f64::from(per_decade));
        format!("{exact:.2e}").parse().unwrap_or(exact)
    };
    (0..=9 * per_decade).map(residual).collect()
}

impl TimedCollection {
    fn timings(&self, variant: usize, goal: f64) -> Vec<Timing> {
        self.solves[variant].iter().map(|solves| solves.timing(goal)).collect()
    }

    /// The steps that begin far from their solution.
    fn far(&self) -> Self {
        let far = |solves: &Vec<TimedSolves>| -> Vec<TimedSolves> {
            solves.iter().filter(|solves| solves.start > FAR).cloned().collect()
        };
        let solves: Vec<_> = self.solves.iter().map(far).collect();
        let count = solves.first().map_or(0, Vec::len);
        let title = format!("the {count} of them that begin with a residual above {FAR:e}");
        Self { title, solves, ..self.clone() }
    }

    /// The smallest residual that any method reached, step by step, rising.
    fn floors(&self) -> Vec<f64> {
        let steps = self.solves.first().map_or(0, Vec::len);
        let smallest = |step: usize| {
            self.solves.iter().map(|solves| solves[step].smallest).fold(f64::INFINITY, f64::min)
        };
        let mut floors: Vec<f64> = (0..steps).map(smallest).collect();
        floors.sort_by(f64::total_cmp);
        floors
    }

    /// Residuals that a family reaches against the median time of its fastest member, ms.
    fn medians(&self, family: Family, goals: &[f64]) -> Vec<(f64, f64)> {
        let its = || (0..self.variants.len()).filter(|&one| self.variants[one].family() == family);
        let point = |&goal: &f64| {
            let times = its().filter_map(|one| median_with_failures(&self.timings(one, goal)));
            Some((1e3 * times.reduce(f64::min)?, goal))
        };
        goals.iter().filter_map(point).collect()
    }
}

fn residuals_sheet(bench: &Bench, all: &[TimedCollection], goals: &[f64]) -> Sheet {
    let tightest = goals.iter().copied().fold(1.0, f64::min);
    let loosest = goals.iter().copied().fold(0.0, f64::max);
    let mut charts = Vec::new();
    for timed in all {
        let curves = Family::ALL.map(|family| (family, timed.medians(family, goals)));
        let times = || curves.iter().flat_map(|(_, curve)| curve).map(|(time, _)| *time);
        let least = times().fold(f64::INFINITY, f64::min).min(1.0);
        let most = times().fold(0.0, f64::max).max(10.0 * least);
        let mut chart = Chart::new(
            timed.title.clone(),
            // Room for the names of curves.
            Axis::log("time of a step (ms)", 0.7 * least, 8.0 * most),
            // Room for names above, too.
            Axis::log("residual", 0.4 * tightest, 8.0 * loosest),
        );
        let mut ends = Vec::new();
        for (family, curve) in curves {
            let end = curve.last();
            ends.extend(end.map(|&end| (family.name().to_owned(), family.colour(), end)));
            let (name, curve) = (family.name(), points(curve));
            chart.layers.push(Layer::quiet(name, curve, family.colour(), Look::LineAndDots));
        }
        chart.add_end_labels(ends);
        charts.push(chart);
    }
    let charted = all.first().map_or(&[][..], |timed| &timed.variants);
    let caption = bench.caption(&[
        "The fastest member of each family, to each residual: median time, warm start. A curve ends where no member solves \
         half of the steps any further.",
        &variants::members(charted),
    ]);
    Sheet { size: (600 * charts.len() as u32, 600), charts, caption }
}

/// How the steps were timed, and the residual floors of each collection.
fn words(all: &[TimedCollection]) -> String {
    let mut lines = vec![format!(
        "Times are minima of at least {LEAST_REPEATS} repeats, but for solves of more than {LONG_SOLVE_SECS} s; means \
         geometric. A solve is given up after {MOST_SWEEPS} sweeps or a limit of time; where nsgs gave up, the \
         time it took until then stands for the time it would need, and the ratio is a lower bound.\n"
    )];
    for timed in all {
        let floors = timed.floors();
        let share = |below: f64| {
            let count = floors.iter().filter(|floor| **floor <= below * (1.0 + ROUNDING)).count();
            format!("{below:e} in {:.0} %", 100.0 * count as f64 / floors.len().max(1) as f64)
        };
        lines.push(format!(
            "* {}, each given up after about {} s: smallest residual that any method reached at most {}; largest {:.1e}.",
            timed.title,
            timed.limit_secs,
            [1e-10, 1e-8, 1e-6, 1e-3].map(share).join(", "),
            floors.last().copied().unwrap_or(0.0)
        ));
    }
    lines.join("\n")
}

/// What each variant comes to: over all steps, and over those that begin far from their solution.
fn summary(name: &str, all: &[TimedCollection]) -> ReportTable {
    let columns = "collection method residual share_solved mean_ms ratio_to_nsgs_at_least";
    let mut rows = Vec::new();
    let parts = all.iter().flat_map(|all| [all.clone(), all.far()]);
    for timed in parts.filter(|timed| !timed.solves[0].is_empty()) {
        let is_base = |one: &ChartedVariant| (one.solver.method, one.solver.ordering) == BASE;
        let base = timed.variants.iter().position(is_base).unwrap_or(0);
        for goal in REPORTED {
            for (number, variant) in timed.variants.iter().enumerate() {
                let timings = timed.timings(number, goal);
                let solved = timings.iter().filter(|timing| timing.solved);
                let mean_ms = geometric_mean(solved.map(|timing| 1e3 * timing.secs));
                let ratio = speed_ratio(&timed.timings(base, goal), &timings);
                let mut row = vec![timed.title.clone(), variant.name.clone(), format!("{goal:e}")];
                row.push(format!("{:.3}", share_solved(&timings)));
                row.extend(
                    [mean_ms, ratio].map(|x| x.map_or(String::new(), |x| format!("{x:.4}"))),
                );
                rows.push(row);
            }
        }
    }
    ReportTable { name: format!("{name}-ratios"), columns: columns.split(' ').collect(), rows }
}

fn times(name: &str, all: &[TimedCollection], goals: &[f64]) -> ReportTable {
    let columns = "problem contacts start_residual method residual seconds solved smallest_residual velocity_error";
    let mut rows = Vec::new();
    for timed in all {
        for &goal in goals {
            for (variant, solves) in timed.variants.iter().zip(&timed.solves) {
                for (problem, solves) in timed.problems.iter().zip(solves) {
                    let TimedSolves { contacts, start, smallest, .. } = solves;
                    let Timing { secs, solved } = solves.timing(goal);
                    let error = solves.reached(goal).map(|reached| reached.velocity_error);
                    rows.push(vec![
                        problem.clone(),
                        contacts.to_string(),
                        format!("{start:e}"),
                        variant.name.clone(),
                        format!("{goal:e}"),
                        format!("{secs:e}"),
                        solved.to_string(),
                        format!("{smallest:e}"),
                        error.map_or(String::new(), |error| format!("{error:e}")),
                    ]);
                }
            }
        }
    }
    ReportTable { name: format!("{name}-times"), columns: columns.split(' ').collect(), rows }
}
