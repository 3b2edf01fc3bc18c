//! What races come to, in words and as tables.

use super::super::Bench;
use super::super::race::Course;
use super::raced::{PROFILED, Raced, summary};
use crate::performance::{Timing, median_with_failures};

/// The curves of one panel as the window reads them.
pub(super) fn for_window(bench: &Bench, raced: &Raced, course: &Course) -> String {
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

/// Markdown: shares solved, times, ratios and residual floors.
pub(super) fn told(raced: &[Raced], course: &Course) -> String {
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
pub(super) fn tables(raced: &[Raced], course: &Course) -> Vec<(String, String)> {
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
