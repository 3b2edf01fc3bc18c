//! The figure: a panel a goal, a curve a method.

use super::super::Bench;
use super::super::look::{colour, line_layers};
use super::plan::{BONDS, CERTIFIED, Plan, RESIDUALS, UNIT_SWEEPS, goals};
use super::raced::Raced;
use crate::chart::{Axis, Chart, Layer, Look, Rgb, Sheet, points};

/// Beside the sizes on either side of the axis, as a factor.
const MARGIN: f64 = 1.8;
/// Of the limit: where what did not reach its goal stands, and where the axis ends.
const GIVEN_UP: [f64; 2] = [2.0, 4.0];
/// Where the axis begins, in steps of the unit.
const LEAST: f64 = 0.2;
/// From ring to ring, in widths of the panel.
const RING: f64 = 0.03;
const GREY: Rgb = (130, 130, 130);

/// Draws what the methods came to.
pub(super) fn draw(bench: &Bench, plan: &Plan, raced: &Raced) -> Sheet {
    let residuals = RESIDUALS.map(|goal| (format!("to a residual of {goal:e}"), goal, false));
    let gap = raced.largest_gap(CERTIFIED);
    let certified = (format!("tresca to {CERTIFIED:e}, gap up to {gap:.1e}"), CERTIFIED, true);
    let mut charts: Vec<Chart> = residuals
        .into_iter()
        .chain([certified])
        .enumerate()
        .map(|(panel, (title, goal, of_models))| {
            let mut chart = axes(plan, raced, title, panel == 0);
            let is_in = |&number: &usize| {
                let entrant = &plan.entrants[number];
                goals(entrant).contains(&goal) && entrant.is_of_model() == of_models
            };
            let racing: Vec<usize> = (0..plan.entrants.len()).filter(is_in).collect();
            for (place, &number) in racing.iter().enumerate() {
                let aside = (place, racing.len());
                chart.layers.extend(entrant_layers(plan, raced, (number, goal), aside));
            }
            chart
        })
        .collect();
    let legend = Chart::legend_of(&mut charts, 0.6);
    charts.push(legend);
    let steps = raced.summary(0, 0, RESIDUALS[0]).steps;
    let state = if raced.state == "rest" { "at rest in its box" } else { "that begins to slump" };
    let bonds = BONDS.map(|bond| bond.to_string()).join(" and ");
    let units: Vec<String> =
        (0..raced.sizes.len()).map(|size| format!("{:.2}", 1e3 * raced.unit_secs(size))).collect();
    Sheet {
        size: (2400, 940),
        charts,
        caption: bench.caption(&[
            &format!(
                "Median over {steps} steps of a pile {state}, Bond {bonds}, Δt = 1e-3 s, warm start; in times of a step of {UNIT_SWEEPS} sweeps of nsgs, beside which each was measured ({} ms).",
                units.join(", ")
            ),
            &format!(
                "Above the upper line: half of the steps or more do not get there within {} times. Shares: steps that reach the last goal of each, size by size.",
                plan.limit
            ),
        ]),
    }
    .high_enough()
}

fn axes(plan: &Plan, raced: &Raced, title: String, is_first: bool) -> Chart {
    let grains = || raced.sizes.iter().map(|(grains, _)| *grains as f64);
    let from = grains().fold(f64::INFINITY, f64::min) / MARGIN;
    let to = grains().fold(0.0, f64::max) * MARGIN;
    let label = if is_first { "time of a step (40 sweeps = 1)" } else { "" };
    let mut x = Axis::log("grains", from, to);
    x.ticks = raced.sizes.iter().map(|(grains, _)| (*grains as f64, grains.to_string())).collect();
    let mut chart = Chart::new(title, x, Axis::log(label, LEAST, GIVEN_UP[1] * plan.limit));
    for (name, height) in [("40 sweeps of nsgs", 1.0), ("the most that is given", plan.limit)] {
        let line = points([from, to].map(|x| (x, height)));
        let look = if height == 1.0 { Look::Line(2) } else { Look::Dashes(2) };
        chart.layers.push(Layer::curve(name, line, GREY, look));
    }
    chart
}

/// A curve through the sizes at which a goal is reached, and rings above the limit where it is not.
fn entrant_layers(
    plan: &Plan,
    raced: &Raced,
    (number, goal): (usize, f64),
    (place, count): (usize, usize),
) -> Vec<Layer> {
    let entrant = &plan.entrants[number];
    let summaries =
        |goal: f64| (0..raced.sizes.len()).map(move |size| raced.summary(size, number, goal));
    let (mut reached, mut missed) = (Vec::new(), Vec::new());
    for ((grains, _), summary) in raced.sizes.iter().zip(summaries(goal)) {
        match summary.median {
            Some(median) => reached.push((*grains as f64, median.max(LEAST))),
            None => missed.push((*grains as f64, GIVEN_UP[0] * plan.limit)),
        }
    }
    let last = goals(entrant).last().copied().unwrap_or(goal);
    let shares: Vec<String> =
        summaries(last).map(|summary| format!("{:.0}", 100.0 * summary.share)).collect();
    let name = format!("{}\nto {last:e}: {} %", entrant.name, shares.join(", "));
    let mut layers = line_layers(entrant.look, name.clone(), reached, true);
    let rings = Layer::quiet(
        format!("{name}, not reached"),
        points(missed),
        colour(entrant.look),
        Look::Rings(6),
    );
    layers.push(rings.aside(RING * (place as f64 - 0.5 * (count as f64 - 1.0))));
    layers
}

#[cfg(test)]
mod tests {
    use super::super::raced::tests::made_up;
    use super::*;

    /// Places of the curves of an entrant, and of the rings of what it did not reach.
    fn places(plan: &Plan, number: usize, goal: f64) -> [Vec<(f64, f64)>; 2] {
        let layers = entrant_layers(plan, &made_up(plan), (number, goal), (0, 1));
        let mut places = [Vec::new(), Vec::new()];
        for layer in layers {
            if let Layer::Curve { name, points, .. } = layer {
                let missed = usize::from(name.contains("not reached"));
                places[missed].extend(points.iter().map(|point| (point.x, point.y)));
            }
        }
        places
    }

    #[test]
    fn what_is_not_reached_stands_above_the_limit() {
        let plan = Plan::new(true);
        let above = GIVEN_UP[0] * plan.limit;
        assert!(above > plan.limit);
        let [reached, missed] = places(&plan, 0, RESIDUALS[0]);
        assert_eq!((reached, missed), (vec![(500.0, 0.5)], vec![(2_000.0, above)]));
        let [reached, missed] = places(&plan, 1, RESIDUALS[0]);
        assert_eq!((reached.len(), missed.len()), (0, 2), "nothing is hidden");
    }
}
