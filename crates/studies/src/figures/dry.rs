//! Whether dry piles that bounce slump under `range` as under `moreau` at a small Δt, and as under `dem`.

use super::claims::Claim;
use super::comparison::{PairedSlumps, claim, margin};
use super::studies::Rows;
use super::{Figure, StudyRunner, slump_point};
use crate::chart::{Axis, Chart, Layer, LegendCorner, Look, PALETTE, Sheet};
use crate::error::Result;
use crate::sim::Stepper;

/// Grains of a pile of the study.
const GRAINS: usize = 138;
/// The laws, and the colours of their curves.
const LAWS: [(Stepper, usize); 3] = [(Stepper::Moreau, 6), (Stepper::Range, 1), (Stepper::Dem, 3)];

pub(super) fn make(studies: &StudyRunner) -> Result<Figure> {
    let rows = studies.rows("dry")?;
    let (mut charts, mut claims) = (Vec::new(), Vec::new());
    for rho in rows.values(|config| config.parameters.restitution) {
        let here = rows.such_that(|config| config.parameters.restitution == Some(rho));
        charts.push(chart(&here, rho));
        for law in [Stepper::Moreau, Stepper::Dem] {
            claims.push(agrees(&here, rho, law));
        }
    }
    let caption = vec![format!(
        "Bond 0; means over {} initial states of 138 grains with 95 % intervals.",
        rows.seeds().len()
    )];
    let sheet = Sheet { size: (1600, 720), charts, caption };
    Ok(Figure { name: "dry", sheet, claims, table: None })
}

/// The runs of a law.
fn of<'a>(rows: &Rows<'a>, law: Stepper) -> Rows<'a> {
    rows.such_that(|config| config.stepper == Some(law))
}

fn chart(rows: &Rows<'_>, rho: f64) -> Chart {
    let x = Axis::log("Δt (s)", 7e-5, 7e-3);
    let mut chart =
        Chart::new(format!("Dry piles, ρ = {rho}"), x, Axis::linear("slump Δy_G", 0.4, 0.6));
    chart.legend = LegendCorner::UpperRight;
    for (index, (law, colour)) in LAWS.into_iter().enumerate() {
        let here = of(rows, law);
        let point = |step: f64| slump_point(step, &here.of_step(step).slumps());
        let points = here.steps().into_iter().map(point).collect();
        let layer = Layer::curve(law.name(), points, PALETTE[colour], Look::LineAndDots);
        chart.layers.push(layer.beside(index, LAWS.len()));
    }
    chart
}

/// That piles slump under `range`, at all its Δt, as under another law at the smallest.
fn agrees(rows: &Rows<'_>, rho: f64, law: Stepper) -> Claim {
    let (reference, range) = (of(rows, law), of(rows, Stepper::Range));
    let least = reference.steps().first().copied().unwrap_or_default();
    let reference = reference.of_step(least);
    let pairs = |step: f64| {
        PairedSlumps::new(format!("{step:e} s"), (0.0, step), &reference, &range.of_step(step))
    };
    let all: Vec<PairedSlumps> = range.steps().into_iter().map(pairs).collect();
    let margin = margin(GRAINS);
    let said = format!(
        "Beyond the paper: dry piles of ρ = {rho} slump under range at every Δt as under {law} at {least:e} s, within {margin}"
    );
    claim(said.replace("e-", "e−"), &all, margin)
        .hanging_on("restitution without which nothing below 2 g·Δt bounces, but under dem; the rough base; slump alone")
}
