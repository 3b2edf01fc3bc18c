//! The runs in words and as a table.

use super::super::runs::TimedRun;
use super::plan::{Plan, REFERENCE};
use super::runs::Charted;
use crate::study::statistics::mean;

/// The report's lines.
pub(super) fn told(plan: &Plan, charted: &[Charted], floor: f64) -> String {
    let mut lines = vec![
        format!(
            "Two references at the same Δt, solved to residuals of {:e} and {:e}, differ by {floor:.4} in the \
             mean: no smaller error means anything. Runs that take more than {} s a simulated second are \
             given up as too slow. Every time is the least of {}.",
            REFERENCE[0],
            REFERENCE[1],
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
