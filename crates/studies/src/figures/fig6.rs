//! Draws Fig. 6 of Abramian & Staron (2020): slump against the cohesive time Bond·Δt/√(d/g), with mean diameter d and
//! gravity g. Tests the guess of the paper that the slump falls with increasing cohesive time up to a cohesive time of
//! 1, and rises beyond it. At 1, cohesion cancels in one step an opening speed of √(g d).

use rand::{RngExt, SeedableRng};

use super::claims::{Alike, Claim, SIGNIFICANT, Verdict};
use super::studies::{ensemble, groups};
use super::{Figure, StudyRunner};
use crate::chart::{Axis, Chart, INK, Layer, Look, PALETTE, Point, Sheet, points};
use crate::error::Result;
use crate::harness::MeasuredCase;
use crate::statistics::{mean, p_of_either, p_value, slope, turning_point};

const RESAMPLINGS: usize = 400;
/// Number of resamplings of the initial states after each shuffle of Δt among the runs. They give the confidence
/// interval of the turning point, the cohesive time at which the slump turns from falling to rising. The cohesive time
/// is Bond·Δt/√(d/g), dimensionless, with the Bond number, the time step Δt (s), the mean diameter d (m) and gravity g
/// (m/s²). The number is smaller than [`RESAMPLINGS`] to save time. With fewer resamplings the interval is narrower, so
/// it more often excludes 1, the turning point that Abramian & Staron (2020) presume.
const FEWER_RESAMPLINGS: usize = 20;

/// Mean diameter d of the grains of the piles, m.
const DIAMETER: f64 = 5e-3;
/// Gravity g in the scenes of the piles, m/s².
const GRAVITY: f64 = 9.8;

/// Returns log₁₀ of the cohesive time Bond·Δt/√(d/g) of a run, with mean diameter d and gravity g.
pub(super) fn log_time(run: &MeasuredCase) -> f64 {
    (run.at("bond") * run.at("dt") / unit_secs()).log10()
}

/// Returns √(d/g), the time unit of the piles, s, with mean diameter d and gravity g.
pub(super) fn unit_secs() -> f64 {
    (DIAMETER / GRAVITY).sqrt()
}

pub(super) fn make(studies: &StudyRunner) -> Result<Figure> {
    let cohesive = studies.rows("pile")?.such_that(|run| run.at("bond") > 0.0);
    let rows = ensemble(&cohesive);
    let mut chart = Chart::new(
        "Fig. 6: slump against cohesive time",
        Axis::log("Bond·Δt/√(d/g)", 0.06, 32.0),
        Axis::linear("slump", 0.0, 0.6),
    );
    let one = points([(1.0, 0.0), (1.0, 0.6)]);
    chart.layers.push(Layer::curve("the paper's guess", one, INK, Look::Dashes(2)));
    for (index, bond) in rows.values("bond").into_iter().enumerate() {
        let of_bond = rows.with("bond", bond);
        let means = of_bond.values("dt").into_iter().map(|step| {
            let mean = mean(&of_bond.with("dt", step).readings("slump"));
            let interval = Some((mean.low.max(0.0), mean.high));
            Point { x: bond * step / unit_secs(), y: mean.mean, interval }
        });
        let name = format!("Bond {bond}");
        let curve = Layer::curve(name, means.collect(), PALETTE[index + 1], Look::LineAndDots);
        chart.layers.push(curve);
    }
    let groups = groups(&rows, log_time, |run| run.reading("slump"));
    let count = rows.values("seed").len();
    let turn = turning(&joined(&groups, count), RESAMPLINGS);
    let Turn { place, low, high } = turn;
    let mut sheet = Sheet::of(chart);
    sheet.caption = vec![format!(
        "Means over {count} initial states with 95 % intervals (Bond 0 has no cohesive time). A broken line \
         bends at {place:.2} ({low:.2} … {high:.2})."
    )];
    let claims = vec![regimes(&groups, count), guess(&groups, count, turn)];
    Ok(Figure { name: "fig6", sheet, claims, table: None })
}

/// Merges groups of runs, one group per initial state and Bond number, into one group per initial state. In `groups`,
/// the groups with the same initial state are next to each other. `count` is the number of initial states.
fn joined(groups: &[Alike], count: usize) -> Vec<Alike> {
    groups.chunks((groups.len() / count.max(1)).max(1)).map(<[_]>::concat).collect()
}

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
    .shuffled(groups, |_| 0.0, holds)
    .hanging_on(format!(
        "the shifted cone; three Bonds drawn as one curve; a broken line as the shape of the curve. By chance: of \
         {FEWER_RESAMPLINGS} resamplings a shuffle"
    ))
}

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
    let measured = format!(
        "slope per decade below {}, slope per decade above {}; both: {}",
        below.signed(3),
        above.signed(3),
        p_value(p_of(groups))
    );
    Claim::new(
        "Fig. 6: below a cohesive time of 1 the slump falls with it, above it rises",
        measured.replace('-', "−"),
        Verdict::of(p_of(groups), p_of_either(below.p_above(0.0), above.p_below(0.0))),
    )
    .shuffled(groups, |_| 0.0, |groups| p_of(groups) < SIGNIFICANT)
    .hanging_on(
        "the shifted cone; 1 as the border; and on Bonds together: below 1 there is more of Bond 20, above of Bond 100",
    )
}

/// Cohesive time Bond·Δt/√(d/g) (mean diameter d, gravity g; dimensionless) at which the slump turns from falling to
/// rising, with its 95 % confidence interval, which is computed by resampling the initial states.
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
