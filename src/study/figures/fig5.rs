//! Fig. 5: slump (a) and mean overlap (b) against Δt at four Bond numbers, as means over initial
//! states, with the single state of Fig. 4 as thin lines.

use super::verdict::Verdict;
use super::workshop::Rows;
use super::{Claim, Figure, Workshop};
use crate::error::Result;
use crate::scene::{Config, NewPile};
use crate::study::Outcome;
use crate::study::chart::{Axis, Chart, Corner, Layer, Look, PALETTE, Point, Sheet, points};
use crate::study::statistics::{mean, p_value, slope};

/// A pile whose slump changes by less than this per decade of Δt is flat: a tenth of what the paper's
/// cohesive piles do.
const FLAT_PER_DECADE: f64 = 0.02;

pub(super) fn slump(workshop: &Workshop) -> Result<Figure> {
    let rows = workshop.rows("pile")?;
    let y = Axis::linear("slump Δy_G", 0.0, 0.7);
    let chart = chart(&rows, "Fig. 5a: slump after 1 s", y, |outcome| outcome.slump);
    let claims = [
        (0.0, "at Bond 0 the slump does not depend on Δt", flat as Test),
        (20.0, "at Bond 20 it falls as Δt grows", falling),
        (50.0, "at Bond 50 it has a minimum", minimum),
        (100.0, "at Bond 100 it rises as Δt grows", rising),
    ];
    let claims = claims.into_iter().map(|(bond, said, test)| {
        let rows = rows.such_that(|config| config.parameters.bond == Some(bond));
        let (measured, verdict) = test(&by_seed(&rows));
        Claim::new(format!("Fig. 5a: {said}"), measured, verdict)
    });
    let claims = claims.collect();
    Ok(Figure { name: "fig5a", sheet: sheet(workshop, &rows, chart), claims, table: None })
}

pub(super) fn overlap(workshop: &Workshop) -> Result<Figure> {
    let rows = workshop.rows("pile")?;
    let y = Axis::log("mean overlap δ/d", 1e-5, 0.2);
    let mut chart =
        chart(&rows, "Fig. 5b: mean overlap during 1 s", y, |outcome| outcome.mean_overlap);
    chart.legend = Corner::UpperLeft;
    let cohesive = rows.such_that(|config| config.parameters.bond > Some(0.0));
    let slopes: Vec<f64> = cohesive
        .seeds()
        .into_iter()
        .map(|seed| {
            let of_seed = cohesive.such_that(|config| config.origin.seed == Some(seed));
            let log = |(config, outcome): &(&Config, &Outcome)| {
                (
                    config.parameters.time_step_secs.unwrap_or(1.0).log10(),
                    outcome.mean_overlap.max(1e-12).log10(),
                )
            };
            slope(&of_seed.0.iter().map(log).collect::<Vec<_>>())
        })
        .collect();
    let exponent = mean(&slopes);
    let largest = rows.outcomes(|outcome| outcome.mean_overlap).into_iter().fold(0.0, f64::max);
    let grows = Claim::new(
        "Fig. 5b: the mean overlap grows with Δt",
        format!(
            "δ ∝ Δt^{:.2} over all Bond > 0, 95 % interval {:.2} … {:.2}",
            exponent.mean, exponent.low, exponent.high
        ),
        Verdict::of(exponent.p_above(0.0), exponent.p_below(0.0)),
    );
    let range = Claim::new(
        "Fig. 5b: it stays below 0.06 d, where the paper's axis ends",
        format!("largest mean overlap of a run {largest:.3} d"),
        (largest < 0.06).into(),
    );
    Ok(Figure {
        name: "fig5b",
        sheet: sheet(workshop, &rows, chart),
        claims: vec![grows, range],
        table: None,
    })
}

fn chart(rows: &Rows<'_>, title: &str, y: Axis, number: fn(&Outcome) -> f64) -> Chart {
    let mut chart = Chart::new(title, Axis::log("Δt (s)", 8e-5, 6.5e-3), y);
    let bonds = rows.values(|config| config.parameters.bond);
    for (index, &bond) in bonds.iter().enumerate() {
        let of_bond = rows.such_that(|config| config.parameters.bond == Some(bond));
        let colour = PALETTE[index % PALETTE.len()];
        let steps = of_bond.values(|config| config.parameters.time_step_secs);
        let shared = steps.iter().filter_map(|&step| {
            let is_it = |config: &Config| {
                config.parameters.time_step_secs == Some(step)
                    && config.origin.seed == Some(NewPile::default().seed)
            };
            Some((step, *of_bond.such_that(is_it).outcomes(number).first()?))
        });
        let name = format!("Bond {bond}, single state");
        chart.layers.push(Layer::quiet(name, points(shared), colour, Look::Line(1)));
        let means = steps.iter().map(|&step| {
            let mean = mean(
                &of_bond.such_that(|c| c.parameters.time_step_secs == Some(step)).outcomes(number),
            );
            Point { x: step, y: mean.mean, interval: Some((mean.low.max(1e-6), mean.high)) }
        });
        let name = format!("Bond {bond}");
        let curve = Layer::curve(name, means.collect(), colour, Look::LineAndDots);
        chart.layers.push(curve.beside(index, bonds.len()));
    }
    chart
}

fn sheet(workshop: &Workshop, rows: &Rows<'_>, chart: Chart) -> Sheet {
    let mut sheet = Sheet::of(chart);
    sheet.caption = vec![format!(
        "Means over {} initial states of 138 grains with 95 % intervals; thin: the one state of Fig. 4.",
        rows.seeds().len()
    )];
    sheet.caption.extend(workshop.note());
    sheet
}

/// Slumps of one initial state by log₁₀ Δt, rising.
type OfSeed = Vec<(f64, f64)>;
type Test = fn(&[OfSeed]) -> (String, Verdict);

fn by_seed(rows: &Rows<'_>) -> Vec<OfSeed> {
    let of_seed = |seed| {
        let rows = rows.such_that(|config| config.origin.seed == Some(seed));
        let mut pairs: OfSeed = rows
            .0
            .iter()
            .map(|(config, outcome)| {
                (config.parameters.time_step_secs.unwrap_or(1.0).log10(), outcome.slump)
            })
            .collect();
        pairs.sort_by(|one, other| one.0.total_cmp(&other.0));
        pairs
    };
    rows.seeds().into_iter().map(of_seed).collect()
}

fn slopes(states: &[OfSeed]) -> crate::study::statistics::Mean {
    mean(&states.iter().map(|pairs| slope(pairs)).collect::<Vec<_>>())
}

fn told(what: &str, mean: &crate::study::statistics::Mean) -> String {
    let text = format!(
        "{what} {:+.3}, 95 % interval {:+.3} … {:+.3}, {} states",
        mean.mean, mean.low, mean.high, mean.count
    );
    text.replace('-', "−")
}

fn flat(states: &[OfSeed]) -> (String, Verdict) {
    let slope = slopes(states);
    let p = slope.p_within(FLAT_PER_DECADE);
    let p_not = slope.p_above(FLAT_PER_DECADE).min(slope.p_below(-FLAT_PER_DECADE));
    let told = told("slope per decade", &slope);
    (format!("{told}; within ±{FLAT_PER_DECADE}: {}", p_value(p)), Verdict::of(p, p_not))
}

fn falling(states: &[OfSeed]) -> (String, Verdict) {
    let slope = slopes(states);
    let p = slope.p_below(0.0);
    let told = told("slope per decade", &slope);
    (format!("{told}; below 0: {}", p_value(p)), Verdict::of(p, slope.p_above(0.0)))
}

fn rising(states: &[OfSeed]) -> (String, Verdict) {
    let slope = slopes(states);
    let p = slope.p_above(0.0);
    let told = told("slope per decade", &slope);
    (format!("{told}; above 0: {}", p_value(p)), Verdict::of(p, slope.p_below(0.0)))
}

/// Both ends lie above the mean of what is between them, state by state. Which Δt is lowest is not
/// asked, so that nothing is picked after the fact.
fn minimum(states: &[OfSeed]) -> (String, Verdict) {
    let rise = |end: fn(&OfSeed) -> f64| {
        let over = |pairs: &OfSeed| {
            let inner = &pairs[1..pairs.len() - 1];
            end(pairs) - inner.iter().map(|(_, slump)| slump).sum::<f64>() / inner.len() as f64
        };
        mean(&states.iter().filter(|pairs| pairs.len() > 2).map(over).collect::<Vec<_>>())
    };
    let left = rise(|pairs| pairs[0].1);
    let right = rise(|pairs| pairs[pairs.len() - 1].1);
    let p = left.p_above(0.0).max(right.p_above(0.0));
    let p_not = left.p_below(0.0).min(right.p_below(0.0));
    let measured = format!(
        "{}; {}; both above 0: {}",
        told("smallest Δt above those between", &left),
        told("largest Δt above those between", &right),
        p_value(p)
    );
    (measured, Verdict::of(p, p_not))
}
