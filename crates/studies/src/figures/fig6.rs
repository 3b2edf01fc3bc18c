//! Fig. 6: slump against the cohesive time Bond·Δt/√(d/g), and whether 1 parts two regimes.

use rand::{RngExt, SeedableRng};

use super::chance::{self, Alike};
use super::verdict::{SIGNIFICANT, Verdict};
use super::workshop::Rows;
use super::{Claim, Figure, Workshop};
use crate::chart::{Axis, Chart, INK, Layer, Look, PALETTE, Point, Sheet, points};
use crate::config::Config;
use crate::error::Result;
use crate::scene::paper_pile;
use crate::statistics::{mean, p_value, slope, turning_point};

/// Resamplings of the initial states for the interval of the turning point.
const RESAMPLINGS: usize = 400;
/// As many for each of many shuffles.
const FEWER_RESAMPLINGS: usize = 20;

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
    let cohesive = workshop.rows("pile")?.such_that(|config| config.parameters.bond > Some(0.0));
    let rows = cohesive.ensemble();
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

    let groups = groups(&rows, unit_secs);
    let count = rows.seeds().len();
    let turn = turning(&joined(&groups, count), RESAMPLINGS);
    let Turn { place, low, high } = turn;
    let mut sheet = Sheet::of(chart);
    sheet.caption = vec![format!(
        "Means over {count} initial states with 95 % intervals (Bond 0 has no cohesive time). A broken line \
         bends at {place:.2} ({low:.2} … {high:.2})."
    )];
    sheet.caption.extend(workshop.note());
    let claims = vec![regimes(&groups, count), guess(&groups, count, turn)];
    Ok(Figure { name: "fig6", sheet, claims, table: None })
}

/// Slumps by log₁₀ of the cohesive time, a group a state and Bond, the states one after the other.
fn groups(rows: &Rows<'_>, unit_secs: f64) -> Vec<Alike> {
    let mut all = Vec::new();
    for seed in rows.seeds() {
        for bond in rows.values(|config| config.parameters.bond) {
            let here = rows.such_that(|config| {
                config.source.seed == Some(seed) && config.parameters.bond == Some(bond)
            });
            let place = |(config, outcome): &(&Config, &crate::Outcome)| {
                (cohesive_time(config, unit_secs).log10(), outcome.slump)
            };
            all.push(here.0.iter().map(place).collect());
        }
    }
    all
}

/// The groups of each of `count` states in one.
fn joined(groups: &[Alike], count: usize) -> Vec<Alike> {
    groups.chunks((groups.len() / count.max(1)).max(1)).map(<[_]>::concat).collect()
}

/// That two regimes part at 1.
fn guess(groups: &[Alike], count: usize, turn: Turn) -> Claim {
    let verdict = |turn: Turn| Verdict::of_interval(1.0, turn.low, turn.high);
    let holds = |groups: &[Alike]| {
        verdict(turning(&joined(groups, count), FEWER_RESAMPLINGS)) == Verdict::Holds
    };
    Claim::new(
        "Fig. 6: two regimes part at a cohesive time of 1",
        format!(
            "the best broken line through all runs bends at {:.2}; {:.2} … {:.2} in 95 % of {RESAMPLINGS} resamplings \
             of the initial states",
            turn.place, turn.low, turn.high
        ),
        verdict(turn),
    )
    .by_chance(chance::told(chance::share(groups, |_| 0.0, holds)))
    .hanging_on("the shifted cone; three Bonds drawn as one curve; a broken line as the shape of the curve")
}

/// Whether the slump falls and rises.
fn regimes(groups: &[Alike], count: usize) -> Claim {
    let side = |groups: &[Alike], below: bool| {
        let of_state = |state: &Alike| {
            let points: Vec<_> =
                state.iter().copied().filter(|(x, _)| (*x < 0.0) == below).collect();
            slope(&points)
        };
        mean(&joined(groups, count).iter().map(of_state).collect::<Vec<_>>())
    };
    let p_of =
        |groups: &[Alike]| side(groups, true).p_below(0.0).max(side(groups, false).p_above(0.0));
    let (below, above) = (side(groups, true), side(groups, false));
    let told = |name: &str, mean: &crate::statistics::Mean| {
        format!("slope per decade {name} {:+.3} ({:+.3} … {:+.3})", mean.mean, mean.low, mean.high)
    };
    let p = p_of(groups);
    Claim::new(
        "Fig. 6: below a cohesive time of 1 the slump falls with it, above it rises",
        format!("{}, {}; both: {}", told("below", &below), told("above", &above), p_value(p))
            .replace('-', "−"),
        Verdict::of(p, below.p_above(0.0).min(above.p_below(0.0))),
    )
    .by_chance(chance::told(chance::share(groups, |_| 0.0, |groups| p_of(groups) < SIGNIFICANT)))
    .hanging_on(
        "the shifted cone; 1 as the border; and on Bonds together: below 1 there is more of Bond 20, above of Bond 100",
    )
}

/// Where the slump turns, with the interval in which it does so for resampled initial states.
#[derive(Clone, Copy)]
struct Turn {
    place: f64,
    low: f64,
    high: f64,
}

fn turning(states: &[Alike], resamplings: usize) -> Turn {
    let candidates: Vec<f64> = (-20..=24).map(|k| 0.05 * f64::from(k)).collect();
    let at = |sample: &[&Alike]| {
        let all: Vec<_> = sample.iter().flat_map(|state| state.iter().copied()).collect();
        turning_point(&all, &candidates).map(|place| 10f64.powf(place))
    };
    let all: Vec<_> = states.iter().collect();
    let mut random = rand_pcg::Pcg64::seed_from_u64(0);
    let mut turns: Vec<f64> = (0..resamplings)
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
    Turn { place: at(&all).unwrap_or(f64::NAN), low: quantile(0.025), high: quantile(0.975) }
}
