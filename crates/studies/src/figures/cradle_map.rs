//! The cradle's outcome over time step and stopping tolerance.

use super::fig8::is_open;
use super::{Claim, Figure, Workshop};
use crate::chart::{Axis, Cell, Chart, INK, Layer, Look, Rgb, Sheet, points};
use crate::error::Result;
use crate::scene::cradle;

/// Outcome → colour: open is orange, closed is blue.
fn colour(value: f64) -> Rgb {
    if value > 0.5 { (240, 176, 80) } else { (70, 120, 175) }
}

/// The edges of cells around values that are evenly spaced in ratio. Neighbours share theirs to the
/// last bit, so that no gap is drawn between them.
pub(super) fn log_edges(values: &[f64]) -> Vec<[f64; 2]> {
    let half = match values {
        [first, second, ..] => (second / first).sqrt(),
        _ => 1.1,
    };
    let mut edges = vec![values.first().map_or(1.0, |first| first / half)];
    edges.extend(values.windows(2).map(|pair| (pair[0] * pair[1]).sqrt()));
    edges.extend(values.last().map(|last| last * half));
    edges.windows(2).map(|pair| [pair[0], pair[1]]).collect()
}

pub(super) fn make(workshop: &Workshop) -> Result<Figure> {
    let rows = workshop.rows("cradle-map")?;
    let (steps, tolerances) =
        (rows.values(|c| c.parameters.time_step_secs), rows.values(|c| c.solver.tolerance));
    let (step_edges, tolerance_edges) = (log_edges(&steps), log_edges(&tolerances));
    let place = |values: &[f64], value: Option<f64>| {
        values.iter().position(|known| Some(*known) == value).unwrap_or(0)
    };
    let cells: Vec<_> = rows
        .0
        .iter()
        .map(|(config, outcome)| {
            let (column, row) = (
                place(&steps, config.parameters.time_step_secs),
                place(&tolerances, config.solver.tolerance),
            );
            Cell {
                x: (steps[column], step_edges[column]),
                y: (tolerances[row], tolerance_edges[row]),
                value: f64::from(u8::from(is_open(outcome))),
            }
        })
        .collect();
    let ends = |edges: &[[f64; 2]]| (edges[0][0], edges[edges.len() - 1][1]);
    let (x, y) = (ends(&step_edges), ends(&tolerance_edges));
    let mut chart = Chart::new(
        "The cradle's bond: open (orange) or closed (blue)",
        Axis::log("Δt (s)", x.0, x.1),
        Axis::log("stopping tolerance Σ|ΔP|/m (m/s)", y.0, y.1),
    );
    let small = rows.such_that(|config| config.parameters.time_step_secs < Some(3e-3));
    let of_small = |low: f64, high: f64| {
        let picked =
            small.such_that(|c| c.solver.tolerance.is_some_and(|x| (low..high).contains(&x)));
        let open = picked.0.iter().filter(|(_, outcome)| is_open(outcome)).count();
        open as f64 / picked.0.len().max(1) as f64
    };
    let (tight, loose) = (of_small(0.0, 1e-4), of_small(1e-3, 1.0));
    chart.layers.push(Layer::Cells { name: "open".into(), cells, colour });
    // The capture speed Bond·g·Δt, where one step of cohesion cancels what the stop leaves over.
    let scene = cradle();
    let capture = scene.parameters.bond * scene.gravity.magnitude();
    let line = [x.0, x.1].map(|step| (step, (capture * step).clamp(y.0, y.1)));
    chart.layers.push(Layer::curve("Bond·g·Δt", points(line), INK, Look::Dashes(3)));
    let mut sheet = Sheet::of(chart);
    sheet.size = (1200, 960);
    sheet.caption =
        vec![format!("{} × {} runs; k starts 7.865 d left of i.", steps.len(), tolerances.len())];
    sheet.caption.extend(workshop.note());
    let claim = Claim::new(
        "Beyond the paper: at small Δt the outcome hangs on how well the step is solved",
        format!(
            "at Δt < 3·10⁻³ s {:.0} % of bonds open at tolerances below 10⁻⁴ m/s, {:.0} % above 10⁻³",
            100.0 * tight,
            100.0 * loose
        ),
        (loose > tight + 0.1).into(),
    );
    Ok(Figure { name: "cradle-map", sheet, claims: vec![claim], table: None })
}
