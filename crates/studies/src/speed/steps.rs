//! Speed against accuracy of single steps: residual against time, and performance profiles.

use super::collection::CollectionPlan;
use super::performance::{
    SpeedRatio, Timing, geometric_mean, median_with_failures, performance_profiles, share_solved,
    speed_ratio,
};
use super::solves::{
    LEAST_REPEATS, LONG_SOLVE_SECS, MOST_SWEEPS, ROUNDING, SolveTimer, TimedSolves, time_collection,
};
use super::variants::{self, ChartedVariant, staircase};
use super::{Bench, ChartSection, csv_cell, listed};
use crate::chart::{Axis, Chart, Layer, LegendCorner, Sheet};
use crate::error::Result;
use crate::solver::{Method, Ordering};

/// Threshold of restitution with which nearly every step has a solution.
const THRESHOLD: f64 = 2.0;
/// Residuals of the profiles' panels, and of the tables in words.
const PROFILED: [f64; 3] = [1e-3, 1e-6, 1e-8];
/// The method that the others are compared with.
const BASE: (Method, Ordering) = (Method::Nsgs, Ordering::Interleaved);
/// A warm start below this residual leaves next to nothing to be told about a method: the pile rests.
const FAR: f64 = 1e-3;
/// The table that the window shows; a copy lies in `assets/charts/`.
const WINDOW: &str = "chart-window";

/// A collection of steps, and what every variant made of it.
#[derive(Clone)]
struct TimedCollection {
    /// In the names of files.
    label: &'static str,
    /// In titles.
    title: String,
    /// Names of the steps.
    problems: Vec<String>,
    variants: Vec<ChartedVariant>,
    /// By variant, then by step.
    solves: Vec<Vec<TimedSolves>>,
}

/// Times all variants over all collections.
pub(super) fn make(bench: &Bench) -> Result<Vec<ChartSection>> {
    let quick = bench.options.quick;
    let goals = residuals_asked_for(quick);
    let limit_secs = if quick { 0.25 } else { 3.0 };
    let pick = if quick { CollectionPlan::fewer_piles } else { CollectionPlan::piles };
    let mut all = Vec::new();
    for (label, plan, title) in [
        ("", pick(THRESHOLD), "restitution from 2 g·Δt up"),
        ("-paper", pick(0.0), "restitution as in the paper"),
    ] {
        let variants = variants::of_problems(!quick);
        let runner = bench.runner(&format!("steps{label}"))?;
        let solves = time_collection(bench, &runner, &plan, &variants, |simulation, variant| {
            SolveTimer { variant, goals: &goals, limit_secs, keeps_memory: false }.time(simulation)
        })?;
        let problems = plan.names();
        let title = format!("{} steps, {title}", problems.len());
        all.push(TimedCollection { label, title, problems, variants, solves });
    }
    let mut tables = tables(&all, &goals);
    tables.extend(all.first().map(|first| (WINDOW.to_owned(), first.for_window(bench, &goals))));
    let mut sections = vec![ChartSection {
        name: "chart-step".into(),
        sheet: residuals_sheet(bench, &all, &goals),
        report: report(&all, limit_secs),
        tables,
    }];
    sections.extend(all.iter().map(|timed| ChartSection {
        name: format!("chart-step-profiles{}", timed.label),
        sheet: timed.profiles_sheet(bench),
        report: String::new(),
        tables: Vec::new(),
    }));
    Ok(sections)
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

/// What a variant comes to at one residual.
struct StepSummary {
    share_solved: f64,
    mean_secs: Option<f64>,
    /// Against [`BASE`].
    ratio: SpeedRatio,
}

impl TimedCollection {
    fn timings(&self, variant: usize, goal: f64) -> Vec<Timing> {
        self.solves[variant].iter().map(|solves| solves.timing(goal)).collect()
    }

    fn summary(&self, variant: usize, goal: f64) -> StepSummary {
        let timings = self.timings(variant, goal);
        let is_base = |one: &ChartedVariant| (one.solver.method, one.solver.ordering) == BASE;
        let base = self.variants.iter().position(is_base).unwrap_or(0);
        let solved = timings.iter().filter(|timing| timing.solved).map(|timing| timing.secs);
        StepSummary {
            share_solved: share_solved(&timings),
            mean_secs: geometric_mean(solved),
            ratio: speed_ratio(&self.timings(base, goal), &timings),
        }
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

    /// Residuals that a variant reaches against the median time, ms.
    fn medians(&self, variant: usize, goals: &[f64]) -> Vec<(f64, f64)> {
        let point =
            |&goal: &f64| Some((1e3 * median_with_failures(&self.timings(variant, goal))?, goal));
        goals.iter().filter_map(point).collect()
    }

    /// The curves of one panel as the window reads them.
    fn for_window(&self, bench: &Bench, goals: &[f64]) -> String {
        let machine = bench.machine.words();
        let mut text = format!("# {}; {machine}\nmethod,residual,ms_per_step\n", self.title);
        for (number, variant) in self.variants.iter().enumerate() {
            for (ms, goal) in self.medians(number, goals) {
                text.push_str(&format!("{},{goal:e},{ms:e}\n", variant.name));
            }
        }
        text
    }

    /// Performance profiles, a panel a residual.
    fn profiles_sheet(&self, bench: &Bench) -> Sheet {
        let mut charts = Vec::new();
        for (panel, goal) in PROFILED.into_iter().enumerate() {
            let timings: Vec<_> =
                (0..self.variants.len()).map(|variant| self.timings(variant, goal)).collect();
            let profiles = performance_profiles(&timings);
            let most = profiles.iter().flatten().map(|(factor, _)| *factor).fold(10.0, f64::max);
            let most = 10f64.powf(most.log10().ceil());
            let mut chart = Chart::new(
                format!("to a residual of {goal:e}"),
                Axis::log("times the fastest method's time", 1.0, most),
                Axis::linear(if panel == 0 { "share of steps solved" } else { "" }, 0.0, 1.0),
            );
            for (variant, profile) in self.variants.iter().zip(profiles) {
                let failed = profile.len() == 1;
                let name = format!("{}{}", variant.name, if failed { ": none" } else { "" });
                let make = if panel == 0 || failed { Layer::curve } else { Layer::quiet };
                let stairs = staircase(&profile, most);
                chart.layers.push(make(name, stairs, variant.colour(), variant.stroke()));
            }
            chart.legend = LegendCorner::LowerRight;
            charts.push(chart);
        }
        let title = format!(
            "{}; how many are solved within so many times the time of whichever method is fastest on each.",
            self.title
        );
        Sheet { size: (1900, 760), charts, caption: bench.caption(&[&title]) }
    }
}

/// Residual against time, a panel a collection.
fn residuals_sheet(bench: &Bench, all: &[TimedCollection], goals: &[f64]) -> Sheet {
    let tightest = goals.iter().copied().fold(1.0, f64::min);
    let mut charts = Vec::new();
    for timed in all {
        let curves: Vec<Vec<(f64, f64)>> =
            (0..timed.variants.len()).map(|variant| timed.medians(variant, goals)).collect();
        let times = || curves.iter().flatten().map(|(time, _)| *time);
        let least = times().fold(f64::INFINITY, f64::min).min(1.0);
        let most = times().fold(0.0, f64::max).max(10.0 * least);
        let mut chart = Chart::new(
            timed.title.clone(),
            Axis::log("time of a step (ms)", 0.7 * least, 1.5 * most),
            Axis::log("residual", 0.5 * tightest, 0.2),
        );
        for (number, (variant, curve)) in timed.variants.iter().zip(curves).enumerate() {
            let shares = listed(all, |timed| {
                format!("{:.0}", 100.0 * share_solved(&timed.timings(number, 1e-8)))
            });
            let name = format!("{}\nto 10⁻⁸: {shares} %", variant.name);
            chart.layers.extend(variant.marked_curve(name, curve));
        }
        charts.push(chart);
    }
    let count = charts.len() as u32;
    // Each panel has its share of solved steps in the legend.
    let legend = Chart::legend_of(&mut charts, 0.18 + 0.06 * f64::from(count));
    charts.push(legend);
    let caption = bench.caption(&[
        "Median time, warm start; a curve ends where half of the steps are solved no further. To 10⁻⁸: share of \
         steps solved to that residual, panel by panel.",
    ]);
    Sheet { size: (760 * count + 280, 820), charts, caption }
}

/// Markdown: shares solved, times, ratios and residual floors.
fn report(all: &[TimedCollection], limit_secs: f64) -> String {
    let mut lines = vec![format!(
        "Times are minima of at least {LEAST_REPEATS} repeats, but for solves of more than {LONG_SOLVE_SECS} s; means \
         geometric. A solve is given up after {MOST_SWEEPS} sweeps or about {limit_secs} s; where nsgs gave up, the \
         time it took until then stands for the time it would need, and the ratio is a lower bound."
    )];
    for timed in all.iter().flat_map(|all| [all.clone(), all.far()]) {
        lines.push(format!("\n### {}\n", timed.title));
        lines.push(
            "| method | residual | steps solved | mean time of those, ms | times as fast as nsgs where both solve | over all that the method solves, at least |\n|---|---|---|---|---|---|"
                .into(),
        );
        let ratio = |value: Option<f64>, count: usize| {
            value.map_or("none".into(), |value| format!("{value:.2} ({count} steps)"))
        };
        for goal in PROFILED {
            for (number, variant) in timed.variants.iter().enumerate() {
                let summary = timed.summary(number, goal);
                let ms = summary.mean_secs.map(|secs| format!("{:.4}", 1e3 * secs));
                lines.push(format!(
                    "| {} | {goal:e} | {:.1} % | {} | {} | {} |",
                    variant.name,
                    100.0 * summary.share_solved,
                    ms.unwrap_or("failed on all".into()),
                    ratio(summary.ratio.both, summary.ratio.count_both),
                    ratio(summary.ratio.at_least, summary.ratio.count_at_least)
                ));
            }
        }
        let floors = timed.floors();
        let share = |below: f64| {
            let count = floors.iter().filter(|floor| **floor <= below * (1.0 + ROUNDING)).count();
            100.0 * count as f64 / floors.len().max(1) as f64
        };
        lines.push(format!(
            "\nSmallest residual that any method reached: at most 1e-10 in {:.0} % of the steps, 1e-8 in \
             {:.0} %, 1e-6 in {:.0} %, 1e-3 in {:.0} %; largest {:.1e}.",
            share(1e-10),
            share(1e-8),
            share(1e-6),
            share(1e-3),
            floors.last().copied().unwrap_or(0.0)
        ));
    }
    lines.join("\n")
}

/// Every time, and the summary of every residual, as CSV.
fn tables(all: &[TimedCollection], goals: &[f64]) -> Vec<(String, String)> {
    let mut times = String::from(
        "problem,contacts,start_residual,method,residual,seconds,solved,smallest_residual\n",
    );
    let mut ratios = String::from(
        "collection,method,residual,share_solved,mean_seconds,ratio_to_nsgs,ratio_steps,ratio_at_least,ratio_at_least_steps\n",
    );
    for timed in all {
        for &goal in goals {
            for (number, ChartedVariant { name, .. }) in timed.variants.iter().enumerate() {
                for (problem, solves) in timed.problems.iter().zip(&timed.solves[number]) {
                    let TimedSolves { contacts, start, smallest, .. } = solves;
                    let Timing { secs, solved } = solves.timing(goal);
                    times.push_str(&format!(
                        "\"{problem}\",{contacts},{start:e},{name},{goal:e},{secs:e},{solved},{smallest:e}\n",
                    ));
                }
                let StepSummary { share_solved, mean_secs, ratio } = timed.summary(number, goal);
                ratios.push_str(&format!(
                    "\"{}\",{name},{goal:e},{share_solved},{},{},{},{},{}\n",
                    timed.title,
                    csv_cell(mean_secs),
                    csv_cell(ratio.both),
                    ratio.count_both,
                    csv_cell(ratio.at_least),
                    ratio.count_at_least
                ));
            }
        }
    }
    vec![("chart-step-times".into(), times), ("chart-step-ratios".into(), ratios)]
}
