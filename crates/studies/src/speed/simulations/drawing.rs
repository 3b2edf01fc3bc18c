//! The chart of whole simulations, with its Pareto fronts and the other engines.

use std::collections::{BTreeMap, BTreeSet};

use super::super::Bench;
use super::super::look::{colour, dots};
use super::super::peers::{self, PeerRun};
use super::alone::{ALONE, alone, of_peer};
use super::plan::Plan;
use super::runs::{Charted, References};
use crate::chart::{Axis, Chart, INK, Layer, Look, Rgb, Sheet, points};
use crate::performance::pareto_front;

/// Errors below this are drawn here.
const LEAST_ERROR: f64 = 1e-3;
const MEAN: &str = "mean error of Δy_G";
const GREY: Rgb = (130, 130, 130);

/// A panel: where the points of all methods are, and how far two references are from each other.
struct Panel<'a> {
    title: String,
    /// What its errors are.
    errors: &'static str,
    /// (point, its speed and error); those that failed are left out.
    places: Vec<(&'a Charted, (f64, f64))>,
    floor: Option<f64>,
}

/// Draws a point for each method, effort and Δt.
pub(super) fn draw(
    bench: &Bench,
    plan: &Plan,
    charted: &[Charted],
    references: &References,
    peers: &[PeerRun],
) -> Sheet {
    let panels = panels(plan, charted, references);
    let engines = by_engine(plan, peers, references);
    let speeds = || {
        let ours = panels.iter().flat_map(|panel| &panel.places).map(|(_, (speed, _))| *speed);
        ours.chain(engines.values().flatten().map(|(speed, _)| *speed))
    };
    let slowest = 0.7 * speeds().fold(f64::INFINITY, f64::min).min(1.0);
    let fastest = 1.5 * speeds().fold(0.0, f64::max).max(10.0 * slowest);
    let mut charts: Vec<Chart> =
        panels.iter().map(|panel| panel.chart(plan, charted, [slowest, fastest])).collect();
    if let Some(last) = charts.last_mut() {
        let layers = engines.into_iter().enumerate().map(|(index, (engine, places))| {
            let places = points(places.into_iter().map(|(x, y)| (x, y.max(LEAST_ERROR))));
            Layer::curve(engine, places, peers::colour(index), Look::Rings(9))
        });
        last.layers.extend(layers);
    }
    let legend = Chart::legend_of(&mut charts, 0.42);
    charts.push(legend);
    let steps = said(plan.time_steps_secs.iter().map(|step| format!("{step:e} s")));
    let (piles, grains) = (plan.piles.len(), plan.made_as.grains);
    let processors: BTreeSet<&str> = peers.iter().map(|run| run.processor.as_str()).collect();
    let elsewhere = if processors.is_empty() {
        String::new()
    } else {
        format!(" Other engines: from the same state, on {}.", said(processors.iter()))
    };
    let caption = bench.caption(&[
        &format!(
            "A point for each method, effort and Δt (the larger the dot, the larger: {steps}); means over {piles} piles of {grains} grains, and on the right the one without cohesion alone."
        ),
        &format!(
            "References by {}. Slump after {} s. On the lower edge: the reference itself.{elsewhere}",
            plan.reference.name, plan.duration_secs
        ),
    ]);
    Sheet { size: (2500, 900), charts, caption }.high_enough()
}

/// Against the same Δt, against the finest one, and the same of the pile without cohesion.
fn panels<'a>(plan: &Plan, charted: &'a [Charted], references: &References) -> [Panel<'a>; 3] {
    let good = || charted.iter().filter(|point| point.failed.is_none());
    let finest = format!("Δt = {:e} s", plan.finest_secs);
    let of_all =
        |number: usize| good().map(|point| (point, (point.speed, point.errors[number]))).collect();
    let one = charted.iter().filter_map(|point| {
        let alone = alone(plan, point, references)?;
        Some((point, (alone.speed, alone.error)))
    });
    [
        Panel {
            title: "Error of the slump against the same Δt".into(),
            errors: MEAN,
            places: of_all(0),
            floor: Some(references.floor(plan, 0..plan.piles.len())),
        },
        Panel {
            title: format!("Error of the slump against {finest}"),
            errors: MEAN,
            places: of_all(1),
            floor: None,
        },
        Panel {
            title: format!("Bond 0 alone, against {finest}"),
            errors: "error of Δy_G",
            places: one.collect(),
            floor: Some(references.floor(plan, ALONE..ALONE + 1)),
        },
    ]
}

impl Panel<'_> {
    fn chart(&self, plan: &Plan, charted: &[Charted], [from, to]: [f64; 2]) -> Chart {
        let x = Axis::log("simulated seconds per second", from, to);
        let y = Axis::log(self.errors, LEAST_ERROR, 1.0);
        let mut chart = Chart::new(self.title.clone(), x, y);
        if let Some(floor) = self.floor {
            let line = points([from, to].map(|x| (x, floor.max(LEAST_ERROR))));
            let name = "two references\nfrom each other";
            chart.layers.push(Layer::curve(name, line, GREY, Look::Dashes(2)));
        }
        // Below the floor no error is better than another.
        let least = self.floor.unwrap_or(0.0).max(LEAST_ERROR);
        let honest: Vec<_> = self.places.iter().map(|(_, (x, y))| (*x, y.max(least))).collect();
        let front = pareto_front(&honest).into_iter().map(|index| honest[index]);
        chart.layers.push(Layer::curve("Pareto front", points(front), INK, Look::Line(1)));
        for number in 0..plan.entrants.len() {
            chart.layers.extend(self.method_layers(plan, number, charted));
        }
        chart
    }

    /// The dots of one entrant: a layer for each Δt.
    fn method_layers(&self, plan: &Plan, number: usize, charted: &[Charted]) -> Vec<Layer> {
        let entrant = &plan.entrants[number];
        let is_its = |point: &Charted| plan.efforts[point.effort].entrant == number;
        let of_method = || charted.iter().filter(|point| is_its(point));
        let failed = of_method().filter(|point| point.failed.is_some()).count();
        let name = match failed {
            0 => entrant.name.clone(),
            failed => format!("{}\n{failed} of {} failed", entrant.name, of_method().count()),
        };
        let layers = plan.time_steps_secs.iter().enumerate().map(|(size, time_step_secs)| {
            let here = self
                .places
                .iter()
                .filter(|(point, _)| is_its(point) && point.time_step_secs == *time_step_secs);
            let places = points(here.map(|(_, (x, y))| (*x, y.max(LEAST_ERROR))));
            let look = dots(entrant.look, 4 + 2 * size as u32);
            let make = if size == 0 { Layer::curve } else { Layer::quiet };
            make(name.clone(), places, colour(entrant.look), look)
        });
        layers.collect()
    }
}

fn said(words: impl Iterator<Item = impl ToString>) -> String {
    words.map(|word| word.to_string()).collect::<Vec<_>>().join(", ")
}

/// Speed and error of other engines.
fn by_engine<'a>(
    plan: &Plan,
    peers: &'a [PeerRun],
    references: &References,
) -> BTreeMap<&'a str, Vec<(f64, f64)>> {
    let mut by_engine: BTreeMap<&str, Vec<(f64, f64)>> = BTreeMap::new();
    for run in peers {
        let alone = of_peer(plan, run, references);
        by_engine.entry(&run.engine).or_default().push((alone.speed, alone.error));
    }
    by_engine
}
