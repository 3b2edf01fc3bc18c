//! Fig. 5a: slump against Δt at four Bond numbers, as means over initial states, with the single state of Fig. 4 as
//! thin lines; in both readings of the paper's friction cone.

use super::pile_tests::OF_FIG5A;
use super::workshop::Rows;
use super::{Claim, Figure, Workshop};
use crate::Outcome;
use crate::chart::{Axis, Chart, Layer, Look, PALETTE, Point, Sheet, points};
use crate::config::Config;
use crate::error::Result;
use crate::scene::NewPile;
use crate::statistics::mean;

/// What every claim about the slump of piles hangs on besides the cone.
const CHOICES: &str = "the base, a row of fixed discs (the paper names none); the stop, a relative change of 1e−7; \
                       restitution without a threshold; the states. pile-choices has what becomes of it where they are \
                       changed";

/// The cones and the studies in them.
const CONES: [(&str, &str); 2] = [("shifted", "pile"), ("compressive", "pile-compressive")];

pub(super) fn make(workshop: &Workshop) -> Result<Figure> {
    let mut charts = Vec::new();
    let mut claims: Vec<Claim> = Vec::new();
    let mut states = Vec::new();
    for (cone, study) in CONES {
        let all = workshop.rows(study)?;
        let ensemble = all.ensemble();
        let y = Axis::linear("slump Δy_G", 0.0, 0.7);
        let title = format!("Fig. 5a: slump after 1 s, {cone} cone");
        charts.push(chart(&all, &title, time_steps(), y, |outcome| outcome.slump));
        claims.extend(OF_FIG5A.iter().map(|asked| asked.claim(&ensemble, cone, CHOICES)));
        states.push(ensemble.seeds().len());
    }
    let mut sheet = Sheet { size: (2000, 860), charts, caption: Vec::new() };
    sheet.caption = vec![
        format!(
            "Means over {} initial states of 138 grains with 95 % intervals; thin: the one state of Fig. 4, which is in no \
             mean.",
            states[0]
        ),
        "Left |T| ≤ μ(N + C₀), right |T| ≤ μ max(N, 0): the paper's words can be read either way."
            .into(),
    ];
    sheet.caption.extend(workshop.note());
    Ok(Figure { name: "fig5a", sheet, claims, table: None })
}

/// The axis of the paper's time steps.
pub(super) fn time_steps() -> Axis {
    Axis::log("Δt (s)", 8e-5, 6.5e-3)
}

/// A number of all runs against Δt, a curve a Bond.
pub(super) fn chart(
    rows: &Rows<'_>,
    title: &str,
    x: Axis,
    y: Axis,
    number: fn(&Outcome) -> f64,
) -> Chart {
    let mut chart = Chart::new(title, x, y);
    let bonds = rows.values(|config| config.parameters.bond);
    for (index, &bond) in bonds.iter().enumerate() {
        let of_bond = rows.such_that(|config| config.parameters.bond == Some(bond));
        let ensemble = of_bond.ensemble();
        let colour = PALETTE[index % PALETTE.len()];
        let steps = of_bond.values(|config| config.parameters.time_step_secs);
        let shown = steps.iter().filter_map(|&step| {
            let is_it = |config: &Config| {
                config.parameters.time_step_secs == Some(step)
                    && config.source.seed == Some(NewPile::default().seed)
            };
            Some((step, *of_bond.such_that(is_it).outcomes(number).first()?))
        });
        let name = format!("Bond {bond}, single state");
        chart.layers.push(Layer::quiet(name, points(shown), colour, Look::Line(1)));
        let means = steps.iter().map(|&step| {
            let mean = mean(
                &ensemble.such_that(|c| c.parameters.time_step_secs == Some(step)).outcomes(number),
            );
            Point { x: step, y: mean.mean, interval: Some((mean.low.max(1e-6), mean.high)) }
        });
        let name = format!("Bond {bond}");
        let curve = Layer::curve(name, means.collect(), colour, Look::LineAndDots);
        chart.layers.push(curve.beside(index, bonds.len()));
    }
    chart
}
