//! The chart of whole simulations, with its Pareto front and the other engines.

use std::collections::BTreeMap;

use super::super::Bench;
use super::super::look::{colour, dots};
use super::super::peers::{self, PeerRun};
use super::plan::{FINEST_SECS, Plan};
use super::runs::{Charted, References};
use crate::scene::NewPile;
use crate::sim::Stepper;
use crate::study::chart::{Axis, Chart, INK, Layer, Look, Sheet, points};
use crate::study::performance::pareto_front;

/// Errors below this are drawn here.
const LEAST_ERROR: f64 = 1e-3;

/// Draws a point for each method, effort and Δt.
pub(super) fn draw(
    bench: &Bench,
    plan: &Plan,
    charted: &[Charted],
    floor: f64,
    references: &References,
    peers: &[PeerRun],
) -> Sheet {
    let good: Vec<&Charted> = charted.iter().filter(|point| point.failed.is_none()).collect();
    let speeds = || {
        let peers = peers.iter().filter(|run| run.is_collapse_of(NewPile::default().grains));
        good.iter().map(|point| point.speed).chain(peers.map(PeerRun::speed))
    };
    let slowest = speeds().fold(f64::INFINITY, f64::min).min(1.0);
    let fastest = speeds().fold(0.0, f64::max).max(10.0 * slowest);
    let mut charts = Vec::new();
    for (panel, title) in ["against the same Δt", "against Δt = 10⁻⁴ s"].into_iter().enumerate()
    {
        let mut chart = Chart::new(
            format!("Error of the slump {title}"),
            Axis::log("simulated seconds per second", 0.7 * slowest, 1.5 * fastest),
            Axis::log("mean error of Δy_G", LEAST_ERROR, 1.0),
        );
        if panel == 0 {
            let line = [0.7 * slowest, 1.5 * fastest].map(|x| (x, floor.max(LEAST_ERROR)));
            let grey = (130, 130, 130);
            chart.layers.push(Layer::curve(
                "two references\nfrom each other",
                points(line),
                grey,
                Look::Dashes(2),
            ));
        }
        let places: Vec<(f64, f64)> =
            good.iter().map(|point| (point.speed, point.errors[panel].max(LEAST_ERROR))).collect();
        // Below the floor no error is better than another.
        let honest: Vec<_> = places.iter().map(|&(x, y)| (x, y.max(floor))).collect();
        let front = pareto_front(&honest).into_iter().map(|index| honest[index]);
        chart.layers.push(Layer::curve("Pareto front", points(front), INK, Look::Line(1)));
        let drawn: Vec<_> = good.iter().copied().zip(places).collect();
        for number in 0..plan.entrants.len() {
            chart.layers.extend(method_layers(plan, number, charted, &drawn, panel == 1));
        }
        if panel == 1 {
            chart.layers.extend(peer_layers(plan, peers, references));
        }
        charts.push(chart);
    }
    let legend = Chart::legend_of(&mut charts, 0.36);
    charts.push(legend);
    Sheet {
        size: (1900, 820),
        charts,
        caption: bench.caption(&[&format!(
            "A point for each method, effort and Δt (the larger the dot, the larger: {}); means over {} piles of 138 grains. On the lower edge: the reference itself.",
            said(plan.time_steps_secs.iter().map(|step| format!("{step:e} s"))),
            plan.piles.len()
        )]),
    }
}

/// The dots of one entrant, of those that did not fail at their places: a layer for each Δt.
fn method_layers(
    plan: &Plan,
    number: usize,
    charted: &[Charted],
    drawn: &[(&Charted, (f64, f64))],
    mut in_legend: bool,
) -> Vec<Layer> {
    let entrant = &plan.entrants[number];
    let is_its = |point: &Charted| plan.efforts[point.effort].entrant == number;
    let of_method = || charted.iter().filter(|point| is_its(point));
    let failed = of_method().filter(|point| point.failed.is_some()).count();
    let told = match failed {
        0 => entrant.name.clone(),
        failed => format!("{}\n{failed} of {} failed", entrant.name, of_method().count()),
    };
    let mut layers = Vec::new();
    for (size, time_step_secs) in plan.time_steps_secs.iter().enumerate() {
        let here = drawn
            .iter()
            .filter(|(point, _)| is_its(point) && point.time_step_secs == *time_step_secs);
        let layer = points(here.map(|(_, place)| *place));
        let look = dots(entrant.look, 4 + 2 * size as u32);
        let make = if in_legend { Layer::curve } else { Layer::quiet };
        in_legend = false;
        layers.push(make(told.clone(), layer, colour(entrant.look), look));
    }
    layers
}

fn said(words: impl Iterator<Item = String>) -> String {
    words.collect::<Vec<_>>().join(", ")
}

/// Runs of other engines from the shared state without cohesion, against the reference for it.
fn peer_layers(plan: &Plan, peers: &[PeerRun], references: &References) -> Vec<Layer> {
    let shared = (0.0, NewPile::default().seed);
    let Some(pile) = plan.piles.iter().position(|pile| *pile == shared) else { return Vec::new() };
    let reference = references.slump(Stepper::Moreau, FINEST_SECS, pile);
    let mut by_engine: BTreeMap<&str, Vec<(f64, f64)>> = BTreeMap::new();
    for run in peers.iter().filter(|run| run.is_collapse_of(NewPile::default().grains)) {
        let error = (run.slump - reference).abs().max(LEAST_ERROR);
        by_engine.entry(&run.engine).or_default().push((run.speed(), error));
    }
    let layers = by_engine.into_iter().enumerate().map(|(index, (engine, places))| {
        let name = format!("{engine},\nBond 0 alone");
        Layer::curve(name, points(places), peers::colour(index), Look::Rings(9))
    });
    layers.collect()
}
