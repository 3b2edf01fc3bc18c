//! Slump against the number of grains, and against how well each step is solved, at three cohesive
//! times.

use super::claims::{Claim, Verdict};
use super::fig6::{cohesive_time, unit_secs};
use super::studies::Rows;
use super::{Figure, StudyRunner, slump_point};
use crate::chart::{Axis, Chart, Layer, LegendCorner, Look, PALETTE, Sheet};
use crate::config::Config;
use crate::error::Result;
use crate::solver::SolverChanges;
use crate::statistics::{mean, p_value, slope};

/// Initial states from which on a difference that is not seen counts as none.
const FEWEST_STATES: usize = 8;

pub(super) fn size(studies: &StudyRunner) -> Result<Figure> {
    let rows = studies.rows("pile-size")?;
    let grains = |config: &Config| config.source.grains.map(|count| count as f64);
    let counts = rows.values(grains);
    let x = Axis::log("number of grains", 0.8 * counts[0], 1.25 * counts[counts.len() - 1]);
    let (mut sheet, curves) = series(&rows, "Slump against the number of grains", x, grains)?;
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
        let slope = mean(&slopes);
        Claim::new(
            format!("Beyond the paper: at a cohesive time of {time:.1} the slump hangs on the number of grains"),
            format!(
                "slope per decade of grains {}, {} states; not 0: {}",
                slope.signed(3),
                slope.count,
                p_value(slope.p_not_zero())
            ),
            Verdict::of(slope.p_not_zero(), 1.0),
        )
    });
    let claims = claims.collect();
    Ok(Figure { name: "pile-size", sheet, claims, table: None })
}

pub(super) fn tolerance(studies: &StudyRunner) -> Result<Figure> {
    let rows = studies.rows("pile-tolerance")?;
    let values = rows.tolerances();
    let x = Axis::log(
        "relative change at which sweeps stop",
        0.6 * values[0],
        1.6 * values[values.len() - 1],
    );
    let title = "Slump against how well each step is solved";
    let (sheet, _) = series(&rows, title, x, |config| config.solver.tolerance)?;
    let unit_secs = unit_secs()?;
    let claims = rows.steps().into_iter().map(|step| {
        let of_step = rows.of_step(step);
        // The loosest tolerance from which on no mean differs from the tightest one, state by state.
        let differs = |tolerance: f64| {
            let of_seed = |seed| {
                let run = of_step.of_seed(seed);
                let slump = |wanted: f64| run.of_tolerance(wanted).slumps().first().copied();
                Some(slump(tolerance)? - slump(values[0])?)
            };
            let seeds = of_step.seeds().into_iter();
            let difference = mean(&seeds.filter_map(of_seed).collect::<Vec<_>>());
            difference.low > 0.0 || difference.high < 0.0
        };
        let settled = values.iter().copied().take_while(|&tolerance| !differs(tolerance)).last();
        let settled = settled.unwrap_or(values[0]);
        // That no difference is seen says little where few states were looked at.
        let undecided = settled == values[0] || of_step.seeds().len() < FEWEST_STATES;
        let bond = of_step.bonds()[0];
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
type SlopesAtTime = (f64, Vec<f64>);

/// One curve a cohesive time.
fn series(
    rows: &Rows<'_>,
    title: &str,
    x: Axis,
    number: impl Fn(&Config) -> Option<f64>,
) -> Result<(Sheet, Vec<SlopesAtTime>)> {
    let unit_secs = unit_secs()?;
    let mut chart = Chart::new(title, x, Axis::linear("slump Δy_G", 0.0, 0.7));
    chart.legend = LegendCorner::UpperRight;
    let mut curves = Vec::new();
    for (index, step) in rows.steps().into_iter().enumerate() {
        let of_step = rows.of_step(step);
        let time = of_step.0.first().map_or(0.0, |(config, _)| cohesive_time(config, unit_secs));
        let means = of_step.values(&number).into_iter().map(|value| {
            slump_point(value, &of_step.such_that(|c| number(c) == Some(value)).slumps())
        });
        let name = format!("cohesive time {time:.1}");
        let colour = PALETTE[index + 1];
        let curve = Layer::curve(name, means.collect(), colour, Look::LineAndDots);
        chart.layers.push(curve.beside(index, 3));
        let of_seed = |seed| {
            let run = of_step.of_seed(seed);
            let places = run.0.iter().filter_map(|(c, o)| Some((number(c)?.log10(), o.slump)));
            slope(&places.collect::<Vec<_>>())
        };
        curves.push((time, of_step.seeds().into_iter().map(of_seed).collect()));
    }
    let mut sheet = Sheet::of(chart);
    let bond = rows.bonds()[0];
    sheet.caption = vec![format!(
        "Bond {bond}; means over {} initial states, with 95 % intervals from three states up.",
        rows.seeds().len()
    )];
    Ok((sheet, curves))
}
