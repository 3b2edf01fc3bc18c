//! The figure: error of the physics against simulated seconds per second, a chart an experiment.

use super::runs::Ran;
use super::way::{Effort, Way};
use crate::chart::{Axis, Chart, INK, Layer, Look, PALETTE, Rgb, Sheet, points};
use crate::statistics::mean;

/// Errors below this are drawn here.
const LEAST_ERROR: f64 = 1e-3;
/// Errors above this are drawn here.
const MOST_ERROR: f64 = 2.0;
/// Width and height of a chart, pixels.
const WIDTH: u32 = 440;
const HEIGHT: u32 = 400;
/// Charts side by side; fewer leave room for the caption.
const ABREAST: u32 = 4;

/// Draws a point for each experiment and way.
pub(super) fn draw(all: &[Ran], machine: &str) -> Sheet {
    let ways = ways(all);
    let mut charts = Vec::new();
    for of_experiment in all.chunk_by(|one, other| one.experiment.name == other.experiment.name) {
        let chart = chart(of_experiment, &ways);
        // Where no way has a value there is nothing to see.
        if !chart.layers.is_empty() {
            charts.push(chart);
        }
    }
    let count = charts.len() as u32;
    let below = charts.iter_mut().skip(ABREAST as usize).step_by(ABREAST as usize);
    below.for_each(|chart| chart.begins_row = true);
    // Where there are fewer, it has the room of those that are not there.
    let missing = f64::from(ABREAST.saturating_sub(count));
    let legend = Chart::legend_of(&mut charts, 0.9 + missing);
    charts.push(legend);
    let size = (ABREAST * WIDTH + WIDTH * 9 / 10, HEIGHT * count.div_ceil(ABREAST).max(1) + 120);
    let caption = vec![
        "Mean relative deviation of an experiment's quantities from the published values; those below 1e-3 are drawn \
         there."
            .to_owned(),
        "Runs were timed while the other cores ran others.".to_owned(),
        machine.to_owned(),
    ];
    Sheet { size, charts, caption }.high_enough()
}

/// The ways that there are, each once, in their order.
fn ways(all: &[Ran]) -> Vec<Way> {
    let mut ways: Vec<Way> = Vec::new();
    for way in all.iter().filter_map(|ran| ran.way) {
        if !ways.contains(&way) {
            ways.push(way);
        }
    }
    ways
}

/// Mean relative error of the quantities of an experiment in one way; NaN where one has no value, since the others
/// alone would look better than they are.
fn error(ran: &Ran) -> f64 {
    mean(&ran.judged().iter().map(|(quantity, _)| quantity.error()).collect::<Vec<_>>()).mean
}

fn chart(of_experiment: &[Ran], ways: &[Way]) -> Chart {
    let places: Vec<(Option<Way>, (f64, f64))> = of_experiment
        .iter()
        .map(|ran| (ran.way, (ran.speed(), error(ran).clamp(LEAST_ERROR, MOST_ERROR))))
        .filter(|(_, (speed, error))| speed.is_finite() && error.is_finite())
        .collect();
    let speeds = places.iter().map(|(_, (speed, _))| *speed);
    let slowest = speeds.clone().fold(f64::INFINITY, f64::min).min(1e3);
    let fastest = speeds.fold(0.0, f64::max).max(2.0 * slowest);
    let x = Axis::log("simulated seconds per second", 0.5 * slowest, 2.0 * fastest);
    let title = of_experiment.first().map_or("", |ran| ran.experiment.title);
    let mut chart = Chart::new(title, x, Axis::log("relative error", LEAST_ERROR, MOST_ERROR));
    for (way, place) in places {
        let (name, colour, look) = match way {
            None => ("methods of its own".to_owned(), INK, Look::Rings(8)),
            Some(way) => look_of(&way, ways),
        };
        chart.layers.push(Layer::curve(name, points([place]), colour, look));
    }
    chart
}

/// A colour a method and time step; discs for sweeps and rings for residuals, the larger the more work.
fn look_of(way: &Way, ways: &[Way]) -> (String, Rgb, Look) {
    let mut kinds: Vec<(crate::solver::Method, f64)> = Vec::new();
    for one in ways {
        if !kinds.contains(&(one.method, one.time_step_secs)) {
            kinds.push((one.method, one.time_step_secs));
        }
    }
    let kind = (way.method, way.time_step_secs);
    let index = kinds.iter().position(|one| *one == kind).unwrap_or_default();
    let efforts = ways.iter().filter(|one| (one.method, one.time_step_secs) == kind);
    let number = efforts.take_while(|one| *one != way).count();
    let radius = 6 + 2 * number as u32;
    let look = match way.effort {
        Effort::Sweeps(_) => Look::Dots(radius),
        Effort::Residual(_) => Look::Rings(radius),
    };
    let name = format!("{}, Δt {:e} s\n{}", way.method, way.time_step_secs, way.effort.words());
    (name, PALETTE[1 + index % (PALETTE.len() - 1)], look)
}
