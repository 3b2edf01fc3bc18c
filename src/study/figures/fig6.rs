//! Fig. 6: slump against the cohesive time Bond·Δt/√(d/g), and whether 1 parts two regimes.

use rand::{RngExt, SeedableRng};

use super::verdict::Verdict;
use super::{Claim, Figure, Workshop};
use crate::error::Result;
use crate::scene::{Config, paper_pile};
use crate::study::chart::{Axis, Chart, INK, Layer, Look, PALETTE, Point, Sheet, points};
use crate::study::statistics::{mean, p_value, slope, turning_point};

/// Resamplings of the initial states for the interval of the turning point.
const RESAMPLINGS: usize = 400;

/// The cohesive time of a run.
pub(super) fn cohesive_time(config: &Config, unit_secs: f64) -> f64 {
    config.parameters.bond.unwrap_or(0.0) * config.parameters.time_step_secs.unwrap_or(0.0)
        / unit_secs
}

/// √(d/g) of the piles, s.
pub(super) fn unit_secs() -> Result<f64> {
    let pile = paper_pile()?;
    Ok((pile.mean_diameter / pile.gravity.magnitude()).sqrt())
}

pub(super) fn make(workshop: &Workshop) -> Result<Figure> {
    let unit_secs = unit_secs()?;
    let rows = workshop.rows("pile")?.such_that(|config| config.parameters.bond > Some(0.0));
    let mut chart = Chart::new(
        "Fig. 6: slump against cohesive time",
        Axis::log("Bond·Δt/√(d/g)", 0.06, 32.0),
        Axis::linear("slump Δy_G", 0.0, 0.6),
    );
    let one = points([(1.0, 0.0), (1.0, 0.6)]);
    chart.layers.push(Layer::curve("the paper's guess", one, INK, Look::Dashes(2)));
    for (index, bond) in rows.values(|config| config.parameters.bond).into_iter().enumerate() {
        let of_bond = rows.such_that(|config| config.parameters.bond == Some(bond));
        let steps = of_bond.values(|config| config.parameters.time_step_secs);
        let means = steps.into_iter().map(|step| {
            let of_step = of_bond.such_that(|c| c.parameters.time_step_secs == Some(step));
            let mean = mean(&of_step.outcomes(|outcome| outcome.slump));
            Point {
                x: bond * step / unit_secs,
                y: mean.mean,
                interval: Some((mean.low.max(0.0), mean.high)),
            }
        });
        let colour = PALETTE[index + 1];
        chart.layers.push(Layer::curve(
            format!("Bond {bond}"),
            means.collect(),
            colour,
            Look::LineAndDots,
        ));
    }

    let states: Vec<Vec<(f64, f64)>> = rows
        .seeds()
        .into_iter()
        .map(|seed| {
            let of_seed = rows.such_that(|config| config.origin.seed == Some(seed));
            let place = |(config, outcome): &(&Config, &crate::study::Outcome)| {
                (cohesive_time(config, unit_secs).log10(), outcome.slump)
            };
            of_seed.0.iter().map(place).collect()
        })
        .collect();
    let (found, low, high) = turning(&states);
    let guess = Claim::new(
        "Fig. 6: two regimes part at a cohesive time of 1",
        format!(
            "the best broken line through all runs bends at {found:.2}; {low:.2} … {high:.2} in 95 % of \
             {RESAMPLINGS} resamplings of the initial states"
        ),
        Verdict::of_interval(1.0, low, high),
    );
    let mut sheet = Sheet::of(chart);
    sheet.caption = vec![format!(
        "Means over {} initial states with 95 % intervals (Bond 0 has no cohesive time). A broken line \
         bends at {found:.2} ({low:.2} … {high:.2}).",
        states.len()
    )];
    sheet.caption.extend(workshop.note());
    Ok(Figure { name: "fig6", sheet, claims: vec![regimes(&states), guess], table: None })
}

/// Whether the slump falls and rises, over (log₁₀ of the cohesive time, slump) of each initial state.
fn regimes(states: &[Vec<(f64, f64)>]) -> Claim {
    let side = |below: bool| {
        let of_state = |state: &Vec<(f64, f64)>| {
            let points: Vec<_> =
                state.iter().copied().filter(|(x, _)| (*x < 0.0) == below).collect();
            slope(&points)
        };
        mean(&states.iter().map(of_state).collect::<Vec<_>>())
    };
    let (below, above) = (side(true), side(false));
    let told = |name: &str, mean: &crate::study::statistics::Mean| {
        format!("slope per decade {name} {:+.3} ({:+.3} … {:+.3})", mean.mean, mean.low, mean.high)
    };
    let p = below.p_below(0.0).max(above.p_above(0.0));
    Claim::new(
        "Fig. 6: below a cohesive time of 1 the slump falls with it, above it rises",
        format!("{}, {}; both: {}", told("below", &below), told("above", &above), p_value(p))
            .replace('-', "−"),
        Verdict::of(p, below.p_above(0.0).min(above.p_below(0.0))),
    )
}

/// Where the slump turns, with the interval in which it does so for resampled initial states.
fn turning(states: &[Vec<(f64, f64)>]) -> (f64, f64, f64) {
    let candidates: Vec<f64> = (-20..=24).map(|k| 0.05 * f64::from(k)).collect();
    let at = |sample: &[&Vec<(f64, f64)>]| {
        let all: Vec<_> = sample.iter().flat_map(|state| state.iter().copied()).collect();
        turning_point(&all, &candidates).map(|place| 10f64.powf(place))
    };
    let all: Vec<_> = states.iter().collect();
    let mut random = rand_pcg::Pcg64::seed_from_u64(0);
    let mut turns: Vec<f64> = (0..RESAMPLINGS)
        .filter_map(|_| {
            let sample: Vec<_> =
                (0..all.len()).map(|_| all[random.random_range(0..all.len())]).collect();
            at(&sample)
        })
        .collect();
    turns.sort_by(f64::total_cmp);
    let quantile = |share: f64| {
        let index = (share * turns.len().saturating_sub(1) as f64).round() as usize;
        turns.get(index).copied().unwrap_or(f64::NAN)
    };
    (at(&all).unwrap_or(f64::NAN), quantile(0.025), quantile(0.975))
}
