//! What came of it in words and as a table.

use super::plan::{Plan, UNIT_SWEEPS, goals};
use super::raced::Raced;

/// Markdown: how long a step of the unit takes, and what each method comes to.
pub(super) fn told(plan: &Plan, raced: &Raced) -> String {
    let units: Vec<String> = raced
        .sizes
        .iter()
        .enumerate()
        .map(|(size, (grains, _))| {
            format!("{:.2} ms at {grains} grains", 1e3 * raced.unit_secs(size))
        })
        .collect();
    let mut lines = vec![format!(
        "A step of {UNIT_SWEEPS} sweeps of nsgs takes {}. A step is given up where it takes more than {} times \
         that. Medians over all steps; none where half of them or more do not reach the goal.\n\n\
         | grains | method | goal | steps that reach it | times {UNIT_SWEEPS} sweeps | ms | largest duality gap |\n\
         |---|---|---|---|---|---|---|",
        units.join(", "),
        plan.limit
    )];
    let cell = |number: Option<f64>| number.map_or("none".into(), |number| format!("{number:.2}"));
    for (size, (grains, races)) in raced.sizes.iter().enumerate() {
        for (number, entrant) in plan.entrants.iter().enumerate() {
            for &goal in goals(entrant) {
                let summary = raced.summary(size, number, goal);
                let reached = races[number].iter().filter_map(|race| race.reached(goal));
                let gap =
                    reached.filter_map(|reached| reached.duality_gap).fold(f64::NAN, f64::max);
                lines.push(format!(
                    "| {grains} | {} | {goal:e} | {:.0} % of {} | {} | {} | {} |",
                    entrant.name,
                    100.0 * summary.share,
                    summary.steps,
                    cell(summary.median),
                    cell(summary.median_secs.map(|secs| 1e3 * secs)),
                    if gap.is_nan() { String::new() } else { format!("{gap:.1e}") }
                ));
            }
        }
    }
    lines.join("\n")
}

/// Every race as CSV, a row a goal.
pub(super) fn table(plan: &Plan, raced: &Raced) -> String {
    let mut text = String::from(
        "problem,grains,contacts,method,goal,reached,step_secs,times_40_sweeps,solve_secs,left,duality_gap,\
         start,smallest,gave_up_secs\n",
    );
    let cell = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:e}"));
    for (grains, races) in &raced.sizes {
        for (entrant, races) in plan.entrants.iter().zip(races) {
            for race in races {
                for &goal in goals(entrant) {
                    let reached = race.reached(goal);
                    let step_secs = reached.map(|_| race.step_secs(goal));
                    text.push_str(&format!(
                        "\"{}\",{grains},{},{},{goal:e},{},{},{},{},{},{},{:e},{:e},{}\n",
                        race.problem,
                        race.course.contacts,
                        race.method,
                        reached.is_some(),
                        cell(step_secs),
                        cell(step_secs.map(|secs| secs / race.unit_secs)),
                        cell(reached.map(|reached| reached.solve_secs)),
                        cell(reached.map(|reached| reached.left)),
                        cell(reached.and_then(|reached| reached.duality_gap)),
                        race.course.start,
                        race.course.smallest,
                        cell(race.course.gave_up_secs)
                    ));
                }
            }
        }
    }
    text
}
