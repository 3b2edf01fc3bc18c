//! Chart of overlap against cost, with one panel for each number of grains.

use std::error::Error;

use slump_studies::chart::{
    Axis, Chart, Layer, Look, PALETTE, Point, Sheet, pareto_front, png as png_of,
};

use crate::{PILES, Report, Row, Series, name_of};

const ALL: [Series; 6] = [
    Series::Sweeps,
    Series::Rapier,
    Series::Certified,
    Series::Box2d,
    Series::PushOut,
    Series::TgsSoft,
];

/// Draws the smallest overlap that each engine reaches for its cost. Returns the picture as PNG.
pub fn png(report: &Report) -> Result<Vec<u8>, Box<dyn Error>> {
    let of = |(grains, ..): (usize, f64, u64)| {
        panel(&report.rows.iter().filter(|row| row.grains == grains).collect::<Vec<_>>())
    };
    let caption = vec![
        "The pile without cohesion in other engines and under Slump's schemes: the best of each for its cost. Mean overlap \
         of touching grains in a collapse of a second; Δt of 1e-3 and 5e-3 s, one thread."
            .to_owned(),
        format!("{}, {}.", report.processor, report.date),
    ];
    let sheet = Sheet { size: (1200, 600), charts: PILES.map(of).into(), caption };
    Ok(png_of(&sheet, report.command)?)
}

fn panel(rows: &[&Row]) -> Chart {
    let costs = || rows.iter().map(|row| row.secs_per_simulated_sec);
    let least = 0.7 * costs().fold(f64::INFINITY, f64::min);
    let most = 1.5 * costs().fold(0.0, f64::max);
    let overlaps = || rows.iter().map(|row| row.mean_overlap);
    let [low, high] = [overlaps().fold(f64::INFINITY, f64::min), overlaps().fold(0.0, f64::max)];
    let mut chart = Chart::new(
        format!("{} grains", rows.first().map_or(0, |row| row.grains)),
        Axis::log("core seconds per simulated second", least, most),
        Axis::log("mean overlap (d)", 0.6 * low, 1.6 * high),
    );
    for (series, colour) in ALL.into_iter().zip(PALETTE) {
        let its: Vec<&Row> = rows.iter().copied().filter(|row| row.series == series).collect();
        let honest: Vec<(f64, f64)> =
            its.iter().map(|row| (1.0 / row.secs_per_simulated_sec, row.mean_overlap)).collect();
        let point = |index: usize| Point {
            x: its[index].secs_per_simulated_sec,
            y: its[index].mean_overlap,
            interval: None,
        };
        let front: Vec<Point> = pareto_front(&honest).into_iter().rev().map(point).collect();
        chart.layers.push(Layer::curve(name_of(series), front, colour, Look::LineAndDots));
    }
    chart
}
