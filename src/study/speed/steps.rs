//! Speed against accuracy of single steps: residual against time, and performance profiles.

use std::collections::HashMap;

use super::entrants::{self, Entrant};
use super::look::{colour, line_layers, staircase, stroke};
use super::race::{Course, Race, Runner};
use super::{Bench, Part};
use crate::error::Result;
use crate::output::Progress;
use crate::solver::{Method, Ordering};
use crate::study::chart::{Axis, Chart, Corner, Layer, Sheet};
use crate::study::collection::{CollectedStep, CollectionPlan, collect};
use crate::study::performance::{
    SpeedRatio, Timing, geometric_mean, median_with_failures, performance_profiles, share_solved,
    speed_ratio,
};

/// Residuals of the profiles' panels.
const PROFILED: [f64; 3] = [1e-3, 1e-6, 1e-8];
/// The method that the others are compared with.
const BASE: (Method, Ordering) = (Method::Nsgs, Ordering::Interleaved);
/// A warm start below this residual leaves next to nothing to be told about a method: the pile rests.
const FAR: f64 = 1e-3;
/// Threshold of restitution with which nearly every step has a solution.
const THRESHOLD: f64 = 2.0;

/// The table that the window shows; a copy lies in `assets/charts/`.
const WINDOW: &str = "chart-window";

/// A collection and what the methods made of it.
#[derive(Clone)]
struct Raced {
    /// In the names of files.
    label: &'static str,
    /// In titles.
    title: String,
    entrants: Vec<Entrant>,
    /// `races[entrant][problem]`.
    races: Vec<Vec<Race>>,
}

/// Races all methods over all collections and writes what came of it.
pub(super) fn make(bench: &Bench) -> Result<Vec<Part>> {
    let course = course(bench.quick);
    let pick = if bench.quick { CollectionPlan::fewer_piles } else { CollectionPlan::piles };
    let mut parts = Vec::new();
    let mut raced = Vec::new();
    for (label, plan, title) in [
        ("", pick(THRESHOLD), "restitution from 2 g·Δt up"),
        ("-paper", pick(0.0), "restitution as in the paper"),
    ] {
        raced.push(race_all(bench, &plan, &course, label, title)?);
    }
    if bench.large {
        let plan = CollectionPlan::large_piles(THRESHOLD);
        let title = "2,000 grains, restitution from 2 g·Δt up";
        raced.push(race_all(bench, &plan, &course, "-large", title)?);
    }
    parts.push(residuals(bench, &raced, &course));
    for raced in &raced {
        parts.push(profiles(bench, raced));
    }
    Ok(parts)
}

/// Residuals by half decades, or, in the quick pass, decades.
fn course(quick: bool) -> Course {
    let per_decade = if quick { 1 } else { 2 };
    // Written out in decimals, so that 1e-3 is 1e-3.
    let tolerance = |index: i32| {
        let exact = 10f64.powf(-1.0 - f64::from(index) / f64::from(per_decade));
        format!("{exact:.2e}").parse().unwrap_or(exact)
    };
    Course {
        tolerances: (0..=9 * per_decade).map(tolerance).collect(),
        max_sweeps: 200_000,
        limit_secs: if quick { 0.25 } else { 3.0 },
    }
}

fn race_all(
    bench: &Bench,
    plan: &CollectionPlan,
    course: &Course,
    label: &'static str,
    title: &str,
) -> Result<Raced> {
    let (journal, done) = bench.journal::<Race>(&format!("steps{label}"))?;
    let mut done: HashMap<(String, String), Race> =
        done.into_iter().map(|race| ((race.problem.clone(), race.method.clone()), race)).collect();
    let collected = collect(plan, &bench.states_folder())?;
    let entrants = entrants::of_problems(!bench.quick);
    let total = (entrants.len() * collected.len()) as u64;
    let progress = Progress::new(&format!("steps{label}"), total);
    let mut races: Vec<Vec<Race>> = entrants.iter().map(|_| Vec::new()).collect();
    for CollectedStep { name, simulation, .. } in &collected {
        for (entrant, races) in entrants.iter().zip(&mut races) {
            let race = match done.remove(&(name.clone(), entrant.name.clone())) {
                Some(race) => race,
                None => {
                    // The method decides on the order of the problem's rows.
                    let mut simulation = simulation.clone();
                    simulation.set_solver(entrant.sweeps(1))?;
                    let race = simulation.next_problem(Runner { problem: name, entrant, course });
                    journal.add(&race)?;
                    race
                }
            };
            races.push(race);
            progress.advance(1);
        }
    }
    progress.finish();
    let title = format!("{} steps, {title}", collected.len());
    Ok(Raced { label, title, entrants, races })
}

impl Raced {
    fn timings(&self, method: usize, tolerance: f64) -> Vec<Timing> {
        self.races[method].iter().map(|race| race.timing(tolerance)).collect()
    }

    /// The steps that begin far from their solution.
    fn far(&self) -> Self {
        let far = |races: &Vec<Race>| {
            races.iter().filter(|race| race.start_residual > FAR).cloned().collect()
        };
        let races: Vec<Vec<Race>> = self.races.iter().map(far).collect();
        let count = races.first().map_or(0, Vec::len);
        let title = format!("the {count} of them that begin with a residual above {FAR:e}");
        Self { label: self.label, title, entrants: self.entrants.clone(), races }
    }

    fn all_timings(&self, tolerance: f64) -> Vec<Vec<Timing>> {
        (0..self.races.len()).map(|method| self.timings(method, tolerance)).collect()
    }

    /// The smallest residual that any method reached, problem by problem.
    fn floors(&self) -> Vec<f64> {
        let problems = self.races.first().map_or(0, Vec::len);
        let smallest = |problem: usize| {
            let of_method = self.races.iter().map(|races| races[problem].smallest_residual);
            of_method.fold(f64::INFINITY, f64::min)
        };
        (0..problems).map(smallest).collect()
    }
}

/// Residual against time, a panel a collection.
fn residuals(bench: &Bench, all: &[Raced], course: &Course) -> Part {
    let tightest = course.tolerances.iter().copied().fold(1.0, f64::min);
    let mut charts = Vec::new();
    for raced in all {
        let curves: Vec<Vec<(f64, f64)>> = (0..raced.entrants.len())
            .map(|method| {
                let point = |&tolerance: &f64| {
                    let median = median_with_failures(&raced.timings(method, tolerance))?;
                    Some((1e3 * median, tolerance))
                };
                course.tolerances.iter().filter_map(point).collect()
            })
            .collect();
        let times = || curves.iter().flatten().map(|(time, _)| *time);
        let least = times().fold(f64::INFINITY, f64::min).min(1.0);
        let most = times().fold(0.0, f64::max).max(10.0 * least);
        let mut chart = Chart::new(
            raced.title.clone(),
            Axis::log("time of a step (ms)", 0.7 * least, 1.5 * most),
            Axis::log("residual", 0.5 * tightest, 0.2),
        );
        for (method, (entrant, curve)) in raced.entrants.iter().zip(curves).enumerate() {
            let shares = all
                .iter()
                .map(|raced| format!("{:.0}", 100.0 * share_solved(&raced.timings(method, 1e-8))));
            let shares = shares.collect::<Vec<_>>().join(", ");
            let name = format!("{}\nto 10⁻⁸: {shares} %", entrant.name);
            chart.layers.extend(line_layers(entrant.look, name, curve, true));
        }
        charts.push(chart);
    }
    let count = charts.len() as u32;
    // Each panel has its share of solved steps in the legend.
    let legend = Chart::legend_of(&mut charts, 0.18 + 0.06 * f64::from(count));
    charts.push(legend);
    let sheet = Sheet {
        size: (760 * count + 280, 820),
        charts,
        caption: bench.caption(&[
            "Median time, warm start; a curve ends where half of the steps are solved no further. To 10⁻⁸: share of \
             steps solved to that residual, panel by panel.",
        ]),
    };
    let mut tables = tables(all, course);
    tables.extend(all.first().map(|raced| (WINDOW.to_owned(), for_window(bench, raced, course))));
    Part { name: "chart-step".into(), sheet, report: told(all, course), tables }
}

/// The curves of one panel as the window reads them.
fn for_window(bench: &Bench, raced: &Raced, course: &Course) -> String {
    let mut text =
        format!("# {}; {}\nmethod,residual,ms_per_step\n", raced.title, bench.machine.words());
    for (method, entrant) in raced.entrants.iter().enumerate() {
        for &tolerance in &course.tolerances {
            if let Some(secs) = median_with_failures(&raced.timings(method, tolerance)) {
                text.push_str(&format!("{},{tolerance:e},{:e}\n", entrant.name, 1e3 * secs));
            }
        }
    }
    text
}

/// Performance profiles of one collection, a panel a residual.
fn profiles(bench: &Bench, raced: &Raced) -> Part {
    let mut charts = Vec::new();
    for (panel, tolerance) in PROFILED.into_iter().enumerate() {
        let profiles = performance_profiles(&raced.all_timings(tolerance));
        let most = profiles.iter().flatten().map(|(factor, _)| *factor).fold(10.0, f64::max);
        let most = 10f64.powf(most.log10().ceil());
        let mut chart = Chart::new(
            format!("to a residual of {tolerance:e}"),
            Axis::log("times the fastest method's time", 1.0, most),
            Axis::linear(if panel == 0 { "share of steps solved" } else { "" }, 0.0, 1.0),
        );
        for (entrant, profile) in raced.entrants.iter().zip(profiles) {
            let stairs = staircase(&profile, most);
            let failed = profile.len() == 1;
            let name = format!("{}{}", entrant.name, if failed { ": none" } else { "" });
            let layer = if panel == 0 || failed {
                Layer::curve(name, stairs, colour(entrant.look), stroke(entrant.look))
            } else {
                Layer::quiet(name, stairs, colour(entrant.look), stroke(entrant.look))
            };
            chart.layers.push(layer);
        }
        chart.legend = Corner::LowerRight;
        charts.push(chart);
    }
    let title = format!(
        "{}; how many are solved within so many times the time of whichever method is fastest on each.",
        raced.title
    );
    let sheet = Sheet { size: (1900, 760), charts, caption: bench.caption(&[&title]) };
    Part {
        name: format!("chart-step-profiles{}", raced.label),
        sheet,
        report: String::new(),
        tables: Vec::new(),
    }
}

/// A row of what the methods come to at one residual.
fn summary(raced: &Raced, method: usize, tolerance: f64) -> (f64, Option<f64>, SpeedRatio) {
    let timings = raced.timings(method, tolerance);
    let is_base = |entrant: &Entrant| (entrant.method, entrant.ordering) == BASE;
    let base = raced.entrants.iter().position(is_base).unwrap_or(0);
    let solved = timings.iter().filter(|timing| timing.solved).map(|timing| timing.secs);
    let ratio = speed_ratio(&raced.timings(base, tolerance), &timings);
    (share_solved(&timings), geometric_mean(solved), ratio)
}

/// Markdown: shares solved, times, ratios and residual floors.
fn told(raced: &[Raced], course: &Course) -> String {
    let mut lines = vec![format!(
        "Times are minima of at least 3 repeats, means geometric. A solve is given up after {} sweeps or \
         about {} s; where nsgs gave up, the time it took until then stands for the time it would need, \
         and the ratio is a lower bound.",
        course.max_sweeps, course.limit_secs
    )];
    for raced in raced.iter().flat_map(|all| [all.clone(), all.far()]) {
        lines.push(format!("\n### {}\n", raced.title));
        lines.push(
            "| method | residual | steps solved | mean time of those, ms | times as fast as nsgs where both solve | over all that the method solves, at least |\n|---|---|---|---|---|---|"
                .into(),
        );
        for tolerance in PROFILED {
            for (method, info) in raced.entrants.iter().enumerate() {
                let (share, secs, ratio) = summary(&raced, method, tolerance);
                let number = |value: Option<f64>, count: usize| {
                    value.map_or("none".into(), |value| format!("{value:.2} ({count} steps)"))
                };
                lines.push(format!(
                    "| {} | {tolerance:e} | {:.1} % | {} | {} | {} |",
                    info.name,
                    100.0 * share,
                    secs.map_or("failed on all".into(), |secs| format!("{:.4}", 1e3 * secs)),
                    number(ratio.both, ratio.count_both),
                    number(ratio.at_least, ratio.count_at_least)
                ));
            }
        }
        let mut floors = raced.floors();
        floors.sort_by(f64::total_cmp);
        let share = |below: f64| {
            let count = floors.iter().filter(|floor| **floor <= below * (1.0 + 1e-6)).count();
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
fn tables(raced: &[Raced], course: &Course) -> Vec<(String, String)> {
    let mut times = String::from(
        "problem,contacts,start_residual,method,residual,seconds,solved,smallest_residual\n",
    );
    let mut ratios = String::from(
        "collection,method,residual,share_solved,mean_seconds,ratio_to_nsgs,ratio_steps,ratio_at_least,ratio_at_least_steps\n",
    );
    let cell = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:e}"));
    for raced in raced {
        for &tolerance in &course.tolerances {
            for (method, info) in raced.entrants.iter().enumerate() {
                for race in &raced.races[method] {
                    let Timing { secs, solved } = race.timing(tolerance);
                    times.push_str(&format!(
                        "\"{}\",{},{:e},{},{tolerance:e},{secs:e},{solved},{:e}\n",
                        race.problem,
                        race.contacts,
                        race.start_residual,
                        info.name,
                        race.smallest_residual
                    ));
                }
                let (share, secs, ratio) = summary(raced, method, tolerance);
                ratios.push_str(&format!(
                    "\"{}\",{},{tolerance:e},{share},{},{},{},{},{}\n",
                    raced.title,
                    info.name,
                    cell(secs),
                    cell(ratio.both),
                    ratio.count_both,
                    cell(ratio.at_least),
                    ratio.count_at_least
                ));
            }
        }
    }
    vec![("chart-step-times".into(), times), ("chart-step-ratios".into(), ratios)]
}
