//! The charts of single steps.

use super::super::look::{colour, line_layers, staircase, stroke};
use super::super::race::Course;
use super::super::{Bench, Part};
use super::raced::{PROFILED, Raced};
use super::telling::{for_window, tables, told};
use crate::chart::{Axis, Chart, Corner, Layer, Sheet};
use crate::performance::{median_with_failures, performance_profiles, share_solved};

/// The table that the window shows; a copy lies in `assets/charts/`.
const WINDOW: &str = "chart-window";

/// Residual against time, a panel a collection.
pub(super) fn residuals(bench: &Bench, all: &[Raced], course: &Course) -> Part {
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

/// Performance profiles of one collection, a panel a residual.
pub(super) fn profiles(bench: &Bench, raced: &Raced) -> Part {
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
