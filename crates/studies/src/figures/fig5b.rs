//! Fig. 5b: the mean overlap against Δt, on axes that tell an exponent and on the paper's; and whether slump rises with
//! Δt where overlaps are large and contacts are lost.

use super::chance::{self, Alike};
use super::fig5a::{chart, time_steps};
use super::verdict::{SIGNIFICANT, Verdict};
use super::workshop::Rows;
use super::{Claim, Figure, Workshop};
use crate::Outcome;
use crate::chart::{Axis, Corner, Sheet};
use crate::config::Config;
use crate::error::Result;
use crate::statistics::{mean, p_value, slope};

/// The mean overlap at which the paper has contacts begin to be lost, in diameters.
const LARGE_OVERLAP: f64 = 0.01;
/// Where the paper's axis of overlaps ends, in diameters.
const END_OF_AXIS: f64 = 0.06;

pub(super) fn make(workshop: &Workshop) -> Result<Figure> {
    let all = workshop.rows("pile")?;
    let rows = all.ensemble();
    let overlap = |outcome: &Outcome| outcome.mean_overlap;
    let y = Axis::log("mean overlap δ/d", 1e-5, 0.2);
    let mut of_exponent = chart(&all, "Fig. 5b: mean overlap during 1 s", time_steps(), y, overlap);
    of_exponent.legend = Corner::UpperLeft;
    let x = Axis::linear("Δt (s)", 0.0, 5.5e-3);
    let y = Axis::linear("mean overlap δ/d", 0.0, END_OF_AXIS);
    let mut of_paper = chart(&all, "On the paper's axes", x, y, overlap);
    of_paper.legend = Corner::UpperLeft;
    let mut sheet =
        Sheet { size: (2000, 860), charts: vec![of_exponent, of_paper], caption: Vec::new() };
    sheet.caption = vec![format!(
        "Means over {} initial states of 138 grains with 95 % intervals; thin: the one state of Fig. 4, which is in no mean.",
        rows.seeds().len()
    )];
    sheet.caption.extend(workshop.note());
    let cohesive = rows.such_that(|config| config.parameters.bond > Some(0.0));
    let claims = vec![grows(&cohesive), stays_below(&rows), reverses(&cohesive), loses(&cohesive)];
    Ok(Figure { name: "fig5b", sheet, claims, table: None })
}

fn log_step(config: &Config) -> f64 {
    config.parameters.time_step_secs.unwrap_or(1.0).log10()
}

fn grows(cohesive: &Rows<'_>) -> Claim {
    let log_overlap = |outcome: &Outcome| outcome.mean_overlap.max(1e-12).log10();
    let states: Vec<Alike> = groups(cohesive, |outcome| log_overlap(outcome));
    let exponent =
        |states: &[Alike]| mean(&states.iter().map(|state| slope(state)).collect::<Vec<_>>());
    let told = exponent(&states);
    let holds = |states: &[Alike]| exponent(states).p_above(0.0) < SIGNIFICANT;
    let measured = format!(
        "δ ∝ Δt^{:.2} over all Bond > 0, 95 % interval {:.2} … {:.2}",
        told.mean, told.low, told.high
    );
    let verdict = Verdict::of(told.p_above(0.0), told.p_below(0.0));
    Claim::new("Fig. 5b: the mean overlap grows with Δt", measured, verdict)
        .by_chance(chance::told(chance::share(&states, |_| 0.0, holds)))
        .hanging_on("the states; no choice of cone or solver is known that undoes it")
}

fn stays_below(rows: &Rows<'_>) -> Claim {
    let largest = rows.outcomes(|outcome| outcome.mean_overlap).into_iter().fold(0.0, f64::max);
    Claim::new(
        format!("Fig. 5b: it stays below {END_OF_AXIS} d, where the paper's axis ends"),
        format!("largest mean overlap of a run {largest:.3} d"),
        (largest < END_OF_AXIS).into(),
    )
    .by_chance("nothing is drawn at random but the states: a largest value of all runs has no null hypothesis")
    .hanging_on("what counts as overlap: |gap|/d of touching grains, averaged over steps")
}

/// A number of each run by log₁₀ Δt, rising, a group a state and Bond.
fn groups(rows: &Rows<'_>, number: impl Fn(&Outcome) -> f64) -> Vec<Alike> {
    let mut all = Vec::new();
    for seed in rows.seeds() {
        for bond in rows.values(|config| config.parameters.bond) {
            let here = rows.such_that(|config| {
                config.source.seed == Some(seed) && config.parameters.bond == Some(bond)
            });
            let pair =
                |(config, outcome): &(&Config, &Outcome)| (log_step(config), number(outcome));
            let mut runs: Alike = here.0.iter().map(pair).collect();
            runs.sort_by(|one, other| one.0.total_cmp(&other.0));
            all.push(runs);
        }
    }
    all
}

/// Slope of slump between neighbouring Δt where the larger of the two has a mean overlap above the border, less
/// that where it has not, state and Bond by state and Bond; those that lie on one side alone say nothing.
fn turn(slumps: &[Alike], overlaps: &[Alike]) -> Vec<f64> {
    let of_group = |(slumps, overlaps): (&Alike, &Alike)| {
        let pairs = slumps.windows(2).zip(&overlaps[1..]);
        let slopes = pairs.map(|(pair, (_, overlap))| {
            ((pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0), *overlap > LARGE_OVERLAP)
        });
        let (above, below): (Vec<_>, Vec<_>) = slopes.partition(|(_, above)| *above);
        let mean_of = |side: &[(f64, bool)]| {
            let sum: f64 = side.iter().map(|(slope, _)| slope).sum();
            (!side.is_empty()).then(|| sum / side.len() as f64)
        };
        Some(mean_of(&above)? - mean_of(&below)?)
    };
    slumps.iter().zip(overlaps).filter_map(of_group).collect()
}

/// That slump begins to rise with Δt where overlaps are large.
fn reverses(cohesive: &Rows<'_>) -> Claim {
    let slumps = groups(cohesive, |outcome| outcome.slump);
    let overlaps = groups(cohesive, |outcome| outcome.mean_overlap);
    let told = mean(&turn(&slumps, &overlaps));
    let holds = |slumps: &[Alike]| mean(&turn(slumps, &overlaps)).p_above(0.0) < SIGNIFICANT;
    let measured = format!(
        "slope of slump a decade of Δt, above {LARGE_OVERLAP} d less below, at the same state and Bond: {:+.3} \
         ({:+.3} … {:+.3}), {} pairs; above 0: {}",
        told.mean,
        told.low,
        told.high,
        told.count,
        p_value(told.p_above(0.0))
    );
    let verdict = Verdict::of(told.p_above(0.0), told.p_below(0.0));
    let said =
        "The paper's explanation: larger steps weaken piles where the mean overlap is above 1 %";
    Claim::new(said, measured.replace('-', "−"), verdict)
        .by_chance(chance::told(chance::share(&slumps, |_| 0.0, holds)))
        .hanging_on(
            "the shifted cone; and on overlap and Δt growing together: what else grows with Δt would do as well",
        )
}

/// That piles have fewer contacts at larger Δt where they are strong, and that those with fewer slump more.
fn loses(cohesive: &Rows<'_>) -> Claim {
    let strong = cohesive.values(|config| config.parameters.bond).last().copied();
    let strong = cohesive.such_that(|config| config.parameters.bond == strong);
    let contacts = groups(&strong, |outcome| outcome.mean_contacts);
    let slopes = |groups: &[Alike]| mean(&groups.iter().map(|one| slope(one)).collect::<Vec<_>>());
    let falls = slopes(&contacts);
    let slumps = groups(&strong, |outcome| outcome.slump);
    let with = |slumps: &[Alike]| {
        let of_state = |(slumps, contacts): (&Alike, &Alike)| {
            let pairs: Vec<_> = contacts.iter().zip(slumps).map(|(c, s)| (c.1, s.1)).collect();
            slope(&pairs)
        };
        let slopes = slumps.iter().zip(&contacts).map(of_state);
        mean(&slopes.filter(|slope| slope.is_finite()).collect::<Vec<_>>())
    };
    let told = with(&slumps);
    let p = falls.p_below(0.0).max(told.p_below(0.0));
    let p_not = falls.p_above(0.0).min(told.p_above(0.0));
    let holds = |slumps: &[Alike]| falls.p_below(0.0).max(with(slumps).p_below(0.0)) < SIGNIFICANT;
    let measured = format!(
        "at the largest Bond contacts change by {:+.1} a decade of Δt ({:+.1} … {:+.1}), and slump by {:+.4} a contact \
         within a state ({:+.4} … {:+.4}); both below 0: {}",
        falls.mean,
        falls.low,
        falls.high,
        told.mean,
        told.low,
        told.high,
        p_value(p)
    );
    let said = "The paper's explanation: strong piles lose contacts at large Δt, and slump for it";
    Claim::new(said, measured.replace('-', "−"), Verdict::of(p, p_not))
        .by_chance(chance::told(chance::share(&slumps, |_| 0.0, holds)))
        .hanging_on("the shifted cone; which of the two is the cause is not told: a pile that spreads loses contacts, too")
}
