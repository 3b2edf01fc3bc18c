//! The runs in words and as a table.

use super::super::peers::PeerRun;
use super::super::runs::TimedRun;
use super::alone::{ALONE, alone, of_peer};
use super::plan::Plan;
use super::runs::{Charted, References};
use crate::statistics::mean;

/// The report's lines.
pub(super) fn told(
    plan: &Plan,
    charted: &[Charted],
    references: &References,
    peers: &[PeerRun],
) -> String {
    let [tight, tighter] = plan.tolerances;
    let [unsolved, steps] = references.unsolved();
    let mut lines = vec![
        format!(
            "References are by {}. Two at the same Δt, solved to residuals of {tight:e} and {tighter:e}, differ by \
             {:.4} in the mean, and by {:.4} at Bond 0: no smaller error means anything. {unsolved} of their {steps} \
             steps were not solved as asked. Runs that take more than {} s a simulated second are given up as too \
             slow. Every time is the least of {}.",
            plan.reference.name,
            references.floor(plan, 0..plan.piles.len()),
            references.floor(plan, ALONE..ALONE + 1),
            plan.limit_secs,
            if plan.repeats == 1 { "1 run".into() } else { format!("{} runs", plan.repeats) }
        ),
        "\n| method | Δt, s | effort | simulated s per s | error, same Δt | error, finest Δt | verdicts agreed |\n|---|---|---|---|---|---|---|".into(),
    ];
    for point in charted {
        let effort = &plan.efforts[point.effort];
        let (name, step) = (&plan.entrants[effort.entrant].name, point.time_step_secs);
        let effort = &effort.name;
        lines.push(match point.failed {
            Some(why) => format!("| {name} | {step:e} | {effort} | {why} | | | |"),
            None => format!(
                "| {name} | {step:e} | {effort} | {:.2} | {:.4} | {:.4} | {:.0} % |",
                point.speed,
                point.errors[0],
                point.errors[1],
                100.0 * point.verdicts
            ),
        });
    }
    lines.push(told_alone(plan, charted, references, peers));
    lines.join("\n")
}

/// The pile without cohesion, beside what other engines make of it.
fn told_alone(
    plan: &Plan,
    charted: &[Charted],
    references: &References,
    peers: &[PeerRun],
) -> String {
    let mut lines = vec![format!(
        "\nThe pile without cohesion alone, against Δt = {:e} s:\n\n| method | Δt, s | effort | simulated s per s \
         | error | mean overlap, d |\n|---|---|---|---|---|---|",
        plan.finest_secs
    )];
    for point in charted {
        let effort = &plan.efforts[point.effort];
        if let Some(alone) = alone(plan, point, references) {
            lines.push(format!(
                "| {} | {:e} | {} | {:.2} | {:.4} | {:.1e} |",
                plan.entrants[effort.entrant].name,
                point.time_step_secs,
                effort.name,
                alone.speed,
                alone.error,
                alone.mean_overlap
            ));
        }
    }
    for run in peers {
        let alone = of_peer(plan, run, references);
        lines.push(format!(
            "| {} | {:e} | {} substeps, {} Hz, slop {} d | {:.2} | {:.4} | {:.1e} |",
            run.engine,
            run.time_step_secs,
            run.substeps,
            run.contact_hertz,
            run.slop,
            alone.speed,
            alone.error,
            alone.mean_overlap
        ));
    }
    lines.join("\n")
}

/// Every point as CSV.
pub(super) fn table(plan: &Plan, charted: &[Charted]) -> String {
    let mut text = String::from(
        "method,time_step_secs,effort,failed,simulated_secs_per_sec,error_same_step,error_finest_step,\
         verdicts_agreed,mean_overlap,unconverged_steps,steps\n",
    );
    for point in charted {
        let effort = &plan.efforts[point.effort];
        let runs = || point.runs.iter().flatten();
        let overlap = mean(&runs().map(|run| run.mean_overlap).collect::<Vec<_>>()).mean;
        let sum = |number: fn(&TimedRun) -> u64| runs().map(number).sum::<u64>();
        let numbers = match point.failed {
            Some(why) => format!("{why},,,,,,,"),
            None => format!(
                ",{},{},{},{},{overlap},{},{}",
                point.speed,
                point.errors[0],
                point.errors[1],
                point.verdicts,
                sum(|run| run.unconverged_steps),
                sum(|run| run.steps)
            ),
        };
        text.push_str(&format!(
            "{},{:e},{},{numbers}\n",
            plan.entrants[effort.entrant].name, point.time_step_secs, effort.name
        ));
    }
    text
}
