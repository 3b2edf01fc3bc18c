//! Slump against the number of grains, and against how well each step is solved, at three cohesive
//! times.

use super::fig6::{cohesive_time, unit_secs};
use super::verdict::Verdict;
use super::workshop::Rows;
use super::{Claim, Figure, Workshop};
use crate::chart::{Axis, Chart, Corner, Layer, Look, PALETTE, Point, Sheet};
use crate::config::Config;
use crate::error::Result;
use crate::solver::SolverChanges;
use crate::statistics::{mean, p_value, slope};

/// Initial states from which on a difference that is not seen counts as none.
const FEWEST_STATES: usize = 8;

pub(super) fn size(workshop: &Workshop) -> Result<Figure> {
    let rows = workshop.rows("pile-size")?;
    let grains = |config: &Config| config.source.grains.map(|count| count as f64);
    let counts = rows.values(grains);
    let x = Axis::log("number of grains", 0.8 * counts[0], 1.25 * counts[counts.len() - 1]);
    let (mut sheet, curves) =
        series(workshop, &rows, "Slump against the number of grains", x, grains)?;
    let solver = rows.0.first().map_or_else(String::new, |(config, _)| {
        let SolverChanges { method, friction_model, tolerance, .. } = config.solver;
        let (model, residual) = (friction_model.unwrap_or_default(), tolerance.unwrap_or_default());
        let method = method.map_or("", |method| method.name());
        format!("Solved by {method} under {model} to a residual of {residual:e}.")
            .replace("e-", "e−")
    });
    sheet.caption.insert(1, solver);
    if let Some(chart) = sheet.charts.first_mut() {
        chart.x.ticks = counts.iter().map(|count| (*count, count.to_string())).collect();
    }
    let claims = curves.into_iter().map(|(time, slopes)| {
        let told = mean(&slopes);
        let p = told.p_above(0.0).min(told.p_below(0.0)) * 2.0;
        Claim::new(
            format!("Beyond the paper: at a cohesive time of {time:.1} the slump hangs on the number of grains"),
            format!(
                "slope per decade of grains {:+.3} ({:+.3} … {:+.3}), {} states; not 0: {}",
                told.mean, told.low, told.high, told.count, p_value(p.min(1.0))
            ),
            Verdict::of(p, 1.0),
        )
    });
    let claims = claims.collect();
    Ok(Figure { name: "pile-size", sheet, claims, table: None })
}

pub(super) fn tolerance(workshop: &Workshop) -> Result<Figure> {
    let rows = workshop.rows("pile-tolerance")?;
    let values = rows.values(|config| config.solver.tolerance);
    let x = Axis::log(
        "relative change at which sweeps stop",
        0.6 * values[0],
        1.6 * values[values.len() - 1],
    );
    let title = "Slump against how well each step is solved";
    let (sheet, _) = series(workshop, &rows, title, x, |config| config.solver.tolerance)?;
    let unit_secs = unit_secs()?;
    let claims = rows.values(|config| config.parameters.time_step_secs).into_iter().map(|step| {
        let of_step = rows.such_that(|config| config.parameters.time_step_secs == Some(step));
        // The loosest tolerance from which on no mean differs from the tightest one, state by state.
        let differs = |tolerance: f64| {
            let differences: Vec<f64> = of_step
                .seeds()
                .into_iter()
                .filter_map(|seed| {
                    let slump = |wanted: f64| {
                        let run = of_step
                            .such_that(|c| c.source.seed == Some(seed) && c.solver.tolerance == Some(wanted));
                        run.outcomes(|outcome| outcome.slump).first().copied()
                    };
                    Some(slump(tolerance)? - slump(values[0])?)
                })
                .collect();
            let told = mean(&differences);
            told.low > 0.0 || told.high < 0.0
        };
        let settled = values.iter().copied().take_while(|&tolerance| !differs(tolerance)).last();
        let settled = settled.unwrap_or(values[0]);
        // That no difference is seen says little where few states were looked at.
        let undecided = settled == values[0] || of_step.seeds().len() < FEWEST_STATES;
        let bond = of_step.values(|config| config.parameters.bond)[0];
        Claim::new(
            format!(
                "Beyond the paper: how well a step must be solved, at a cohesive time of {:.1}",
                bond * step / unit_secs
            ),
            format!(
                "no difference from a relative change of {:e} is seen at {settled:e} and tighter, {} states",
                values[0], of_step.seeds().len()
            ).replace("e-", "e−"),
            if undecided { Verdict::Open } else { Verdict::Holds },
        )
    });
    let claims = claims.collect();
    Ok(Figure { name: "pile-tolerance", sheet, claims, table: None })
}

/// A cohesive time and its slope for each initial state.
type Slopes = (f64, Vec<f64>);

/// One curve a cohesive time.
fn series(
    workshop: &Workshop,
    rows: &Rows<'_>,
    title: &str,
    x: Axis,
    number: impl Fn(&Config) -> Option<f64>,
) -> Result<(Sheet, Vec<Slopes>)> {
    let unit_secs = unit_secs()?;
    let mut chart = Chart::new(title, x, Axis::linear("slump Δy_G", 0.0, 0.7));
    chart.legend = Corner::UpperRight;
    let mut curves = Vec::new();
    for (index, step) in
        rows.values(|config| config.parameters.time_step_secs).into_iter().enumerate()
    {
        let of_step = rows.such_that(|config| config.parameters.time_step_secs == Some(step));
        let time = of_step.0.first().map_or(0.0, |(config, _)| cohesive_time(config, unit_secs));
        let means = of_step.values(&number).into_iter().map(|value| {
            let mean = mean(&of_step.such_that(|c| number(c) == Some(value)).outcomes(|o| o.slump));
            // Two states tell next to nothing of their spread.
            let interval = (mean.count > 2).then_some((mean.low.max(0.0), mean.high.min(0.7)));
            Point { x: value, y: mean.mean, interval }
        });
        let name = format!("cohesive time {time:.1}");
        let colour = PALETTE[index + 1];
        let curve = Layer::curve(name, means.collect(), colour, Look::LineAndDots);
        chart.layers.push(curve.beside(index, 3));
        let of_seed = |seed| {
            let run = of_step.such_that(|config| config.source.seed == Some(seed));
            let places = run.0.iter().filter_map(|(c, o)| Some((number(c)?.log10(), o.slump)));
            slope(&places.collect::<Vec<_>>())
        };
        curves.push((time, of_step.seeds().into_iter().map(of_seed).collect()));
    }
    let mut sheet = Sheet::of(chart);
    let bond = rows.values(|config| config.parameters.bond)[0];
    sheet.caption = vec![format!(
        "Bond {bond}; means over {} initial states, with 95 % intervals from three states up.",
        rows.seeds().len()
    )];
    sheet.caption.extend(workshop.note());
    Ok((sheet, curves))
}
