//! Makes the section of the report about whole simulations: the chart, the text and the table.

use super::*;
use crate::harness::ReportTable;

/// Least number of piles with which the chart shows confidence intervals of the mean errors. With fewer piles, as in a
/// quick pass, an interval would be as wide as the chart.
const TELLING: usize = 8;

/// Draws two charts of the smallest error of the slump that each family of methods (group of similar solver methods)
/// reaches for its computing time. In the first chart, the error is the difference to the reference simulation at the
/// same time step, in the second chart the difference to the reference simulation at the smallest time step.
pub(super) fn sheet(
    bench: &Bench,
    plan: &SimulationPlan,
    simulated: &[SimulatedPoint],
    references: &References,
) -> Sheet {
    let costs = || simulated.iter().filter(|point| point.failed.is_none()).map(cost);
    let least = 0.6 * costs().fold(f64::INFINITY, f64::min).min(1.0);
    let most = 1.5 * costs().fold(0.0, f64::max).max(10.0 * least);
    let finest = format!("Against Δt = {:e} s: step and solver", FINEST_SECS);
    let panels = [
        ("Against the same Δt: the solver", Some(references.floor(plan))),
        (finest.as_str(), None),
    ];
    let charts: Vec<Chart> = panels
        .into_iter()
        .enumerate()
        .map(|(panel, (title, floor))| {
            let chart = Chart::new(
                title,
                Axis::log("core seconds per simulated second", least, most),
                Axis::log("mean error of the slump", LEAST_ERROR, 1.0),
            );
            with_errors(chart, plan, simulated, panel, floor)
        })
        .collect();
    let steps = listed(&plan.time_steps_secs, |step| format!("{step:e} s"));
    let (piles, grains) = (plan.piles.len(), NewPile::default().grains);
    let intervals = if piles >= TELLING { ", with 95 % intervals" } else { "" };
    let failed_of = |family| {
        let failed = simulated.iter().filter(|point| point.failed.is_some());
        failed.filter(|point| point.variant.charted.family() == family).count()
    };
    let families = Family::ALL.into_iter().filter(|family| failed_of(*family) > 0);
    let failures = listed(families, |family| format!("{} of {}", failed_of(family), family.name()));
    let failures = if failures.is_empty() { "none" } else { &failures };
    let caption = bench.caption(&[
        &format!(
            "What each family comes to at best for its cost{intervals}; means over {piles} piles of {grains} grains, Δt of \
             {steps} and all budgets. Budgets that are too slow or blow up have failed: {failures}. Dashes: two references differ by so much."
        ),
        &variants::members(plan.budgeted.iter().map(|one| &one.charted)),
        &format!("References by {REFERENCE}. Slump after {DURATION_SECS} s."),
    ]);
    Sheet { size: (1200, 640), charts, caption }
}

fn cost(point: &SimulatedPoint) -> f64 {
    1.0 / point.speed
}

fn with_errors(
    mut chart: Chart,
    plan: &SimulationPlan,
    simulated: &[SimulatedPoint],
    panel: usize,
    floor: Option<f64>,
) -> Chart {
    if let Some(floor) = floor {
        let line = points([chart.x.from, chart.x.to].map(|x| (x, floor.max(LEAST_ERROR))));
        let name = "two references from each other";
        chart.layers.push(Layer::quiet(name, line, GREY, Look::Dashes(2)));
    }
    // Errors below the floor, the difference between two references, count as equal.
    let least = floor.unwrap_or(0.0).max(LEAST_ERROR);
    for family in Family::ALL {
        let is_its = |point: &&SimulatedPoint| point.variant.charted.family() == family;
        let good: Vec<_> =
            simulated.iter().filter(is_its).filter(|point| point.failed.is_none()).collect();
        let honest: Vec<(f64, f64)> =
            good.iter().map(|point| (point.speed, point.errors[panel].mean.max(least))).collect();
        let front = pareto_front(&honest).into_iter().rev();
        let front: Vec<Point> = front
            .map(|index| {
                let Mean { mean, low, high, .. } = good[index].errors[panel];
                let inside = |error: f64| error.clamp(LEAST_ERROR, 1.0);
                // With few piles, a confidence interval would be as wide as the chart.
                let is_told = plan.piles.len() >= TELLING;
                let interval = is_told.then(|| (inside(low), inside(high)));
                Point { x: cost(good[index]), y: inside(mean), interval }
            })
            .collect();
        chart.layers.push(Layer::curve(family.name(), front, family.colour(), Look::LineAndDots));
    }
    chart
}

pub(super) fn words(plan: &SimulationPlan, references: &References) -> String {
    let [tight, tighter] = TOLERANCES;
    let [unsolved, steps] = references.unsolved();
    format!(
        "References are by {REFERENCE}. Two at the same Δt, solved to residuals of {tight:e} and {tighter:e}, differ by \
         {:.4} in the mean: no smaller error means anything. {unsolved} of their {steps} steps were not solved as \
         asked. Runs that take more than {} s a simulated second are given up as too slow. Every time is the least \
         of {}.",
        references.floor(plan),
        plan.limit_secs,
        if plan.repeats == 1 { "1 run".into() } else { format!("{} runs", plan.repeats) }
    )
}

pub(super) fn table(simulated: &[SimulatedPoint]) -> ReportTable {
    let columns = "method time_step effort failed simulated_secs_per_sec error_same_step error_finest_step \
                   verdicts_agreed mean_overlap unconverged_steps steps";
    let row = |point: &SimulatedPoint| {
        let runs = &point.runs;
        let overlap = mean(&runs.iter().map(|run| run.mean_overlap).collect::<Vec<_>>()).mean;
        let sum = |number: fn(&TimedRun) -> u64| runs.iter().map(number).sum::<u64>();
        let name = &point.variant.charted.name;
        let mut row = vec![name.clone(), format!("{:e}", point.time_step_secs)];
        row.push(point.variant.change.name.clone());
        row.push(point.failed.clone().unwrap_or_default());
        let [same, finest] = point.errors.map(|error| error.mean);
        let numbers = [point.speed, same, finest, point.verdicts];
        let mut numbers = numbers.map(|x| format!("{x:.4}")).to_vec();
        numbers.push(format!("{overlap:.2e}"));
        numbers.extend(
            [sum(|run| run.unconverged_steps), sum(|run| run.steps)].map(|x| x.to_string()),
        );
        let is_there = point.failed.is_none();
        row.extend(numbers.into_iter().map(|number| if is_there { number } else { String::new() }));
        row
    };
    ReportTable::new("chart-simulation-points", columns, simulated.iter().map(row))
}
