//! Whether dry piles that bounce slump under `range` as under `moreau` at a small Δt, and as under `dem`.

use super::figure::slump_point;
use super::paired::{Place, claim, pairs};
use super::workshop::Rows;
use super::{Claim, Figure, Workshop};
use crate::chart::{Axis, Chart, Corner, Layer, Look, PALETTE, Sheet};
use crate::error::Result;
use crate::sim::Stepper;

/// A difference of slump up to which one law stands for the other, as in other figures of 138 grains.
const MARGIN: f64 = 0.02;

/// The laws, and the colours of their curves.
const LAWS: [(Stepper, usize); 3] = [(Stepper::Moreau, 6), (Stepper::Range, 1), (Stepper::Dem, 3)];

pub(super) fn make(workshop: &Workshop) -> Result<Figure> {
    let rows = workshop.rows("dry")?;
    let (mut charts, mut claims) = (Vec::new(), Vec::new());
    for rho in rows.values(|config| config.parameters.restitution) {
        let here = rows.such_that(|config| config.parameters.restitution == Some(rho));
        charts.push(chart(&here, rho));
        for law in [Stepper::Moreau, Stepper::Dem] {
            claims.push(agrees(&here, rho, law));
        }
    }
    let mut sheet = Sheet { size: (1600, 720), charts, caption: Vec::new() };
    sheet.caption = vec![format!(
        "Bond 0; means over {} initial states of 138 grains with 95 % intervals.",
        rows.seeds().len()
    )];
    sheet.caption.extend(workshop.note());
    Ok(Figure { name: "dry", sheet, claims, table: None })
}

/// The runs of a law at a Δt.
fn of<'a>(rows: &Rows<'a>, law: Stepper, step: f64) -> Rows<'a> {
    rows.such_that(|config| {
        config.stepper == Some(law) && config.parameters.time_step_secs == Some(step)
    })
}

/// The Δt of a law, rising.
fn steps(rows: &Rows<'_>, law: Stepper) -> Vec<f64> {
    let of_law = rows.such_that(|config| config.stepper == Some(law));
    of_law.values(|config| config.parameters.time_step_secs)
}

fn chart(rows: &Rows<'_>, rho: f64) -> Chart {
    let x = Axis::log("Δt (s)", 7e-5, 7e-3);
    let mut chart =
        Chart::new(format!("Dry piles, ρ = {rho}"), x, Axis::linear("slump Δy_G", 0.4, 0.6));
    chart.legend = Corner::UpperRight;
    for (index, (law, colour)) in LAWS.into_iter().enumerate() {
        let point = |&step: &f64| slump_point(step, &of(rows, law, step).outcomes(|one| one.slump));
        let points = steps(rows, law).iter().map(point).collect();
        let layer = Layer::curve(law.name(), points, PALETTE[colour], Look::LineAndDots);
        chart.layers.push(layer.beside(index, LAWS.len()));
    }
    chart
}

/// That piles slump under `range`, at all its Δt, as under another law at the smallest.
fn agrees(rows: &Rows<'_>, rho: f64, law: Stepper) -> Claim {
    let least = steps(rows, law).first().copied().unwrap_or_default();
    let reference = of(rows, law, least);
    let place = |step: f64| Place {
        name: format!("{step:e} s"),
        at: (0.0, step),
        pairs: pairs(&reference, &of(rows, Stepper::Range, step)),
    };
    let places: Vec<Place> = steps(rows, Stepper::Range).into_iter().map(place).collect();
    let said = format!(
        "Beyond the paper: dry piles of ρ = {rho} slump under range at every Δt as under {law} at {least:e} s, within {MARGIN}"
    );
    claim(said.replace("e-", "e−"), &places, MARGIN)
        .hanging_on("restitution without which nothing below 2 g·Δt bounces, but under dem; the rough base; slump alone")
}
