//! How simulations are drawn and told.

use super::*;
use crate::report::ReportTable;

/// Draws a point for each variant, budget and Δt: against the same Δt, and against the finest one.
pub(super) fn sheet(
    bench: &Bench,
    plan: &SimulationPlan,
    simulated: &[SimulatedPoint],
    references: &References,
) -> Sheet {
    let good = || simulated.iter().filter(|point| point.failed.is_none()).map(|point| point.speed);
    let slowest = 0.7 * good().fold(f64::INFINITY, f64::min).min(1.0);
    let fastest = 1.5 * good().fold(0.0, f64::max).max(10.0 * slowest);
    let finest = format!("Δt = {:e} s", FINEST_SECS);
    let panels = [("the same Δt", Some(references.floor(plan))), (finest.as_str(), None)];
    let charts: Vec<Chart> = panels
        .into_iter()
        .enumerate()
        .map(|(panel, (against, floor))| {
            let chart = Chart::new(
                format!("Error of the slump against {against}"),
                Axis::log("simulated seconds per second", slowest, fastest),
                Axis::log("mean error of Δy_G", LEAST_ERROR, 1.0),
            );
            with_errors(chart, plan, simulated, panel, floor)
        })
        .collect();
    let steps = listed(&plan.time_steps_secs, |step| format!("{step:e} s"));
    let (piles, grains) = (plan.piles.len(), NewPile::default().grains);
    let caption = bench.caption(&[
        &format!(
            "A point for each method, effort and Δt (the larger the dot, the larger: {steps}); means over {piles} piles of {grains} grains."
        ),
        &format!(
            "References by {}. Slump after {} s. On the lower edge: the reference itself.",
            REFERENCE, DURATION_SECS
        ),
    ]);
    Sheet { size: (1500, 840), charts, caption }
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
        let name = "two references\nfrom each other";
        chart.layers.push(Layer::curve(name, line, GREY, Look::Dashes(2)));
    }
    // Below the floor no error is better than another.
    let least = floor.unwrap_or(0.0).max(LEAST_ERROR);
    let good = || simulated.iter().filter(|point| point.failed.is_none());
    let honest: Vec<_> =
        good().map(|point| (point.speed, point.errors[panel].max(least))).collect();
    let front = pareto_front(&honest).into_iter().map(|index| honest[index]);
    chart.layers.push(Layer::curve("Pareto front", points(front), INK, Look::Line(1)));
    for (number, variant) in plan.variants.iter().enumerate() {
        let is_its = |point: &&SimulatedPoint| point.variant.variant == number;
        let count = simulated.iter().filter(is_its).count();
        let name = match count - good().filter(is_its).count() {
            0 => variant.name.clone(),
            failed => format!("{}\n{failed} of {count} failed", variant.name),
        };
        for (size, time_step_secs) in plan.time_steps_secs.iter().enumerate() {
            let here = good().filter(is_its).filter(|one| one.time_step_secs == *time_step_secs);
            let places = points(here.map(|one| (one.speed, one.errors[panel].max(LEAST_ERROR))));
            let make = if size == 0 { Layer::curve } else { Layer::quiet };
            let dots = variant.dots(4 + 2 * size as u32);
            chart.layers.push(make(name.clone(), places, variant.colour(), dots));
        }
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

pub(super) fn table(plan: &SimulationPlan, simulated: &[SimulatedPoint]) -> ReportTable {
    let columns = "method time_step_secs effort failed simulated_secs_per_sec error_same_step error_finest_step \
                   verdicts_agreed mean_overlap unconverged_steps steps";
    let row = |point: &SimulatedPoint| {
        let runs = &point.runs;
        let overlap = mean(&runs.iter().map(|run| run.mean_overlap).collect::<Vec<_>>()).mean;
        let sum = |number: fn(&TimedRun) -> u64| runs.iter().map(number).sum::<u64>();
        let name = &plan.variants[point.variant.variant].name;
        let mut row = vec![name.clone(), format!("{:e}", point.time_step_secs)];
        row.push(point.variant.budget.clone());
        row.push(point.failed.clone().unwrap_or_default());
        let numbers = [point.speed, point.errors[0], point.errors[1], point.verdicts];
        let mut numbers = numbers.map(|x| format!("{x:.4}")).to_vec();
        numbers.push(format!("{overlap:.2e}"));
        numbers.extend(
            [sum(|run| run.unconverged_steps), sum(|run| run.steps)].map(|x| x.to_string()),
        );
        let is_there = point.failed.is_none();
        row.extend(numbers.into_iter().map(|number| if is_there { number } else { String::new() }));
        row
    };
    let rows = simulated.iter().map(row).collect();
    let name = "chart-simulation-points".to_owned();
    ReportTable { name, columns: columns.split(' ').collect(), rows }
}
