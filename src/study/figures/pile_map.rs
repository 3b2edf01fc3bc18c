//! The slump over Bond number and time step, with contours of the cohesive time.

use std::ops::RangeInclusive;

use super::cradle_map::log_edges;
use super::fig6::unit_secs;
use super::verdict::Verdict;
use super::{Claim, Figure, Workshop};
use crate::error::Result;
use crate::study::chart::{Axis, Cell, Chart, Layer, Look, Rgb, Sheet, points};
use crate::study::statistics::mean;

/// Slump that the scale of colours ends at.
const MOST: f64 = 0.55;
/// Contours of the cohesive time.
const CONTOURS: [f64; 5] = [0.1, 0.3, 1.0, 3.0, 10.0];
const WHITE: Rgb = (255, 255, 255);
/// Steps of the scale of colours.
const SHADES: u32 = 64;

/// Slump → colour: dark is a pile that holds.
fn colour(slump: f64) -> Rgb {
    use plotters::style::RGBColor;
    use plotters::style::colors::colormaps::{ColorMap, ViridisRGB};
    let RGBColor(red, green, blue) =
        ViridisRGB.get_color_normalized(slump.clamp(0.0, MOST), 0.0, MOST);
    (red, green, blue)
}

pub(super) fn make(workshop: &Workshop) -> Result<Figure> {
    let unit_secs = unit_secs()?;
    let rows = workshop.rows("pile-map")?;
    let (bonds, steps) =
        (rows.values(|c| c.parameters.bond), rows.values(|c| c.parameters.time_step_secs));
    let half = 0.5 * (bonds[1] - bonds[0]);
    let edges = log_edges(&steps);
    let mut cells = Vec::new();
    let mut lowest = Vec::new();
    for (index, &bond) in bonds.iter().enumerate() {
        // Counted from one end, so that neighbours share their edges to the last bit.
        let edge = |number: usize| bonds[0] + half * (2.0 * number as f64 - 1.0);
        let mut best = (f64::INFINITY, 0.0);
        for (step, edges) in steps.iter().zip(&edges) {
            let cell = rows.such_that(|c| {
                c.parameters.bond == Some(bond) && c.parameters.time_step_secs == Some(*step)
            });
            let slump = mean(&cell.outcomes(|outcome| outcome.slump)).mean;
            cells.push(Cell {
                x: (bond, [edge(index), edge(index + 1)]),
                y: (*step, *edges),
                value: slump,
            });
            if slump < best.0 {
                best = (slump, *step);
            }
        }
        lowest.push((bond, best.1));
    }
    let (x_from, x_to) = (bonds[0] - half, bonds[bonds.len() - 1] + half);
    let (y_from, y_to) = (edges[0][0], edges[edges.len() - 1][1]);
    let mut chart = Chart::new(
        "Slump after 1 s, with contours of Bond·Δt/√(d/g)",
        Axis::linear("Bond", x_from, x_to),
        Axis::log("Δt (s)", y_from, y_to),
    );
    chart.width = 5.0;
    chart.layers.push(Layer::Cells { name: "mean slump".into(), cells, colour });
    chart.layers.extend(contours(unit_secs, x_to, y_from..=y_to));
    let cohesive: Vec<_> = lowest.iter().copied().filter(|(bond, _)| *bond > 0.0).collect();
    let dots = points(cohesive.iter().copied());
    chart.layers.push(Layer::quiet(
        "lowest slump of each Bond",
        dots,
        (230, 60, 60),
        Look::Dots(6),
    ));

    let claim = claim(&cohesive, &steps, unit_secs);
    let sheet = Sheet {
        size: (1320, 900),
        charts: vec![chart, scale()],
        caption: [vec![format!(
            "Means over {} initial states; red: the Δt of the lowest slump at each Bond number.",
            rows.seeds().len()
        )], workshop.note()].concat(),
    };
    Ok(Figure { name: "pile-map", sheet, claims: vec![claim], table: None })
}

/// Lines of equal cohesive time, each with its number, on axes that end there.
fn contours(unit_secs: f64, most_bond: f64, steps: RangeInclusive<f64>) -> Vec<Layer> {
    let mut layers = Vec::new();
    for time in CONTOURS {
        let line: Vec<_> = (1..=400)
            .map(|k| most_bond * f64::from(k) / 400.0)
            .map(|bond| (bond, time * unit_secs / bond))
            .filter(|(_, step)| steps.contains(step))
            .collect();
        let Some(&(bond, step)) = line.get(line.len() / 2) else { continue };
        let name = format!("cohesive time {time}");
        let look = if time == 1.0 { Look::Line(3) } else { Look::Line(1) };
        layers.push(Layer::quiet(name, points(line), WHITE, look));
        layers.push(Layer::Words { at: (bond, step), text: format!(" {time}"), colour: WHITE });
    }
    layers
}

/// The scale of colours.
fn scale() -> Chart {
    let mut scale =
        Chart::new("", Axis::linear("", 0.0, 1.0), Axis::linear("slump Δy_G", 0.0, MOST));
    scale.x.ticks = vec![(-1.0, String::new())];
    let shade = |k: u32| {
        let at = |k: u32| MOST * f64::from(k) / f64::from(SHADES);
        Cell { x: (0.5, [0.0, 1.0]), y: (at(k), [at(k), at(k + 1)]), value: at(k) }
    };
    let cells = (0..SHADES).map(shade).collect();
    scale.layers.push(Layer::Cells { name: "scale".into(), cells, colour });
    scale
}

/// What the Δt of the lowest slump at each Bond number say of a cohesive time of 1.
fn claim(lowest: &[(f64, f64)], steps: &[f64], unit_secs: f64) -> Claim {
    // Where the lowest slump is at an end of the range, the turn may lie outside.
    let inside = |step: &f64| *step > steps[0] && *step < steps[steps.len() - 1];
    let times: Vec<f64> = lowest
        .iter()
        .filter(|(_, step)| inside(step))
        .map(|(bond, step)| (bond * step / unit_secs).log10())
        .collect();
    let turn = mean(&times);
    let told = |exponent: f64| 10f64.powf(exponent);
    Claim::new(
        "Beyond the paper: over the plane of Bond and Δt the slump is lowest along a cohesive time of 1",
        format!(
            "lowest at a cohesive time of {:.2} (95 % interval {:.2} … {:.2}, {} Bond numbers with the lowest inside the range)",
            told(turn.mean),
            told(turn.low),
            told(turn.high),
            times.len()
        ),
        if times.len() < 3 {
            Verdict::Open
        } else {
            Verdict::of_interval(1.0, told(turn.low), told(turn.high))
        },
    )
}
