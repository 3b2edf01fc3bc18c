//! Counts the solutions that single steps of piles have under Coulomb friction (a step can have several), and measures
//! the distances between them.

use super::collection::{CollectionPlan, over_steps};
use super::solves::{ReferenceSearch, References};
use super::{Bench, ChartSection, listed};
use crate::chart::{Axis, Chart, Layer, Look, PALETTE, Sheet, points};
use crate::error::Result;
use crate::harness::{Effort, ReportTable, Threads};
use crate::solver::SolutionSearch;

const BONDS: [f64; 3] = [0.0, 20.0, 100.0];
/// Time steps Δt of the piles, s.
const TIME_STEPS_SECS: [f64; 2] = [1e-3, 5e-3];
const FRICTIONS: [f64; 3] = [0.2, 0.5, 0.9];
/// Smallest distance between the velocities of two solutions of a step that the chart shows, in units of √(g d), with
/// gravity g and mean diameter d.
const LEAST_DISTANCE: f64 = 1e-6;
/// Factor that shifts the points of a chart horizontally, so that they do not hide each other: for each further Bond
/// number, the number of grains on the x axis is multiplied by this factor.
const ASIDE: f64 = 1.12;

/// A step of a pile, and the result of the search for its solutions.
struct SearchedStep {
    friction: f64,
    grains: usize,
    in_a_box: bool,
    bond: f64,
    time_step_secs: f64,
    found: References,
}

/// Returns descriptions of the collections of steps whose solutions are counted, with their names. Each collection has
/// one number of grains, one friction coefficient, and piles that either move or are at rest.
fn plans(effort: Effort) -> Vec<(String, CollectionPlan)> {
    let sizes: &[(usize, &[f64])] = match effort {
        Effort::Quick => &[(138, &[0.1])],
        Effort::Full => &[(138, &[0.05, 0.1, 0.2]), (500, &[0.05, 0.1, 0.2]), (2_000, &[0.1])],
    };
    let mut plans = Vec::new();
    for &(grains, times_secs) in sizes {
        for in_a_box in [false, true] {
            for friction in FRICTIONS {
                let times_secs = if in_a_box { &[0.02] } else { times_secs };
                let plan = CollectionPlan {
                    bonds: BONDS.to_vec(),
                    time_steps_secs: TIME_STEPS_SECS.to_vec(),
                    times_secs: times_secs.to_vec(),
                    friction: Some(friction),
                    ..CollectionPlan::of_size(grains, in_a_box, effort)
                };
                let state = if in_a_box { "at rest" } else { "moving" };
                let name = format!("{grains} grains, {state}, μ {friction}");
                plans.push((name, plan));
            }
        }
    }
    plans
}

/// Returns the settings of the search for several solutions of a step: the number of initial guesses, the largest
/// number of sweeps, and the tolerance.
fn search(effort: Effort) -> SolutionSearch {
    let max_sweeps = effort.pick(5_000, 20_000);
    SolutionSearch { starts: 4, seed: 1, max_sweeps, tolerance: 1e-10 }
}

/// Searches for the solutions of all collected steps, on all cores, and charts the largest distance between two
/// solutions of a step.
pub(super) fn make(bench: &Bench) -> Result<Vec<ChartSection>> {
    let search = search(bench.effort);
    let mut all = Vec::new();
    let (columns, mut rows) =
        ("piles steps with_several median_distance largest_distance", Vec::new());
    for (name, plan) in plans(bench.effort) {
        let found: Vec<References> = over_steps(bench, "solutions", &plan, Threads::All, |step| {
            Ok(step.next_problem(ReferenceSearch(search)))
        })?;
        let several = found.iter().filter(|it| it.found > 1);
        let mut distances: Vec<f64> = several.map(|it| it.spread).collect();
        distances.sort_by(f64::total_cmp);
        let told = |at: Option<&f64>| at.map_or(String::new(), |it| format!("{it:.1e}"));
        rows.push(vec![
            name,
            found.len().to_string(),
            distances.len().to_string(),
            told(distances.get(distances.len() / 2)),
            told(distances.last()),
        ]);
        let CollectionPlan { grains, in_a_box, friction, .. } = plan;
        let friction = friction.unwrap_or_default();
        let steps = plan.steps().into_iter().zip(found);
        all.extend(steps.map(|([bond, time_step_secs, _], found)| SearchedStep {
            friction,
            grains,
            in_a_box,
            bond,
            time_step_secs,
            found,
        }));
    }
    let summary = ReportTable::new("chart-solutions-piles", columns, rows);
    let words = format!(
        "{} starts a step: the impulses of the step before, none, and random ones that the law allows, each solved with up to {} \
         sweeps of conjugate gradients and then by Newton's method to a residual of {:e}. Two results are two solutions \
         if they are farther apart than both are estimated to be from theirs. Distances are root mean squares of velocities, \
         √(g d).",
        search.starts, search.max_sweeps, search.tolerance
    );
    let (name, tables) = ("chart-solutions".to_owned(), vec![summary, steps(&all)]);
    Ok(vec![ChartSection { name, sheet: sheet(bench, &all), words, tables }])
}

fn sheet(bench: &Bench, all: &[SearchedStep]) -> Sheet {
    let mut charts = Vec::new();
    for (in_a_box, state) in [(false, "moving"), (true, "at rest in a box")] {
        let mut chart = Chart::new(
            format!("Piles {state}"),
            Axis::log("grains", 80.0, 4_000.0),
            Axis::log("farthest solutions of a step, √(g d)", 0.5 * LEAST_DISTANCE, 0.3),
        );
        for (number, bond) in BONDS.into_iter().enumerate() {
            let its = all.iter().filter(|it| it.bond == bond && it.in_a_box == in_a_box);
            let aside = ASIDE.powf(number as f64 - 1.0);
            let place = |it: &SearchedStep| {
                let distance = if it.found.found > 1 { it.found.spread } else { 0.0 };
                (it.grains as f64 * aside, distance.max(LEAST_DISTANCE))
            };
            let name = format!("Bond {bond}");
            let look = Look::Rings(4);
            chart.layers.push(Layer::curve(name, points(its.map(place)), PALETTE[number], look));
        }
        charts.push(chart);
    }
    let caption = bench.caption(&[
        &format!(
            "A ring a step, at the largest distance of two of its solutions; those of one solution at the lower \
                edge. μ = {}; Δt = {} s.",
            listed(FRICTIONS, |it| it.to_string()),
            listed(TIME_STEPS_SECS, |it| format!("{it:e}"))
        ),
    ]);
    Sheet { size: (1200, 600), charts, caption }
}

fn steps(all: &[SearchedStep]) -> ReportTable {
    let columns =
        "grains state bond friction time_step solutions distance estimated_error residual";
    let row = |it: &SearchedStep| {
        let References { found, spread, told, residual, .. } = &it.found;
        vec![
            it.grains.to_string(),
            if it.in_a_box { "at rest" } else { "moving" }.to_owned(),
            it.bond.to_string(),
            it.friction.to_string(),
            format!("{:e}", it.time_step_secs),
            found.to_string(),
            format!("{spread:e}"),
            format!("{told:e}"),
            format!("{residual:e}"),
        ]
    };
    ReportTable::new("chart-solutions-steps", columns, all.iter().map(row))
}
