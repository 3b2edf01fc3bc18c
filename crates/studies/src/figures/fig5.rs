//! Draws Fig. 5 of Abramian & Staron (2020): slump (a) and mean overlap (b) of piles against the time step Δt, as means
//! over initial states. Thin lines show the single initial state of Fig. 4. The statements of their article are tested
//! on differences between runs from the same initial state. The report also says how often each test finds its
//! statement
//! true by chance.

use super::claims::{Alike, Claim, SIGNIFICANT, Verdict};
use super::studies::{ensemble, groups, log_step};
use super::{Figure, StudyRunner};
use crate::chart::{Axis, Chart, Layer, Look, PALETTE, Point, Sheet, points};
use crate::error::Result;
use crate::harness::{MeasuredCase, Measurements};
use crate::scene::NewPile;
use crate::statistics::{Mean, mean, p_of_either, p_value, slope};

/// Text for the report: the choices, except the friction cone, on which every verdict about the slump of piles depends.
const CHOICES: &str = "the base, a row of fixed discs (the paper names none); the stop, a relative change of 1e−7; \
                       restitution without a threshold; the states. `slump budget` tells what each of them adds";
const CONES: [(&str, &str); 2] = [("shifted", "pile"), ("compressive", "pile-compressive")];
/// Largest change of the slump per decade of Δt at which the slump of a pile counts as independent of Δt. It is a tenth
/// of the change that Abramian & Staron (2020) report for cohesive piles.
const FLAT_PER_DECADE: f64 = 0.02;
/// Mean overlap, in mean diameters, above which grains begin to lose contacts according to Abramian & Staron (2020).
const LARGE_OVERLAP: f64 = 0.01;
/// Largest mean overlap on the axis of Fig. 5b of Abramian & Staron (2020), in mean diameters.
const END_OF_AXIS: f64 = 0.06;

/// A statement of Abramian & Staron (2020) about their Fig. 5a at one Bond number: the Bond number, the statement in
/// words, its test, and the slope of the slump per decade of the time step Δt at which the statement changes from false
/// to true.
type SlumpClaim = (f64, &'static str, SlumpTest, f64);
/// A test of a statement about the slump. Its input is a list for each initial state: log₁₀ Δt and slump of each run,
/// by increasing Δt. It returns the measurement in words and the verdict.
type SlumpTest = fn(&[Alike]) -> (String, Verdict);

const SLUMP_CLAIMS: [SlumpClaim; 4] = [
    (0.0, "at Bond 0 the slump does not depend on Δt", flat, FLAT_PER_DECADE),
    (20.0, "at Bond 20 it falls as Δt grows", falling, 0.0),
    (50.0, "at Bond 50 it has a minimum", minimum, 0.0),
    (100.0, "at Bond 100 it rises as Δt grows", rising, 0.0),
];

pub(super) fn slump(studies: &StudyRunner) -> Result<Figure> {
    let mut charts = Vec::new();
    let mut claims: Vec<Claim> = Vec::new();
    let mut states = Vec::new();
    for (cone, study) in CONES {
        let all = studies.rows(study)?;
        let ensemble = ensemble(&all);
        let y = Axis::linear("slump", 0.0, 0.7);
        let title = format!("Fig. 5a: slump after 1 s, {cone} cone");
        charts.push(chart(&all, &title, time_steps(), y, "slump"));
        claims.extend(SLUMP_CLAIMS.map(|(bond, said, test, border)| {
            let of_bond = ensemble.with("bond", bond);
            let states = groups(&of_bond, log_step, |run| run.reading("slump"));
            let (measured, verdict) = test(&states);
            let holds = |states: &[Alike]| test(states).1 == Verdict::Holds;
            Claim::new(format!("Fig. 5a, {cone} cone: {said}"), measured, verdict)
                .shuffled(&states, |log_step| border * log_step, holds)
                .hanging_on(CHOICES)
        }));
        states.push(ensemble.values("seed").len());
    }
    let caption = vec![
        format!(
            "Means over {} initial states of 138 grains with 95 % intervals; thin: the one state of Fig. 4, which is in no \
             mean.",
            states[0]
        ),
        "Left |T| ≤ μ(N + C₀), right |T| ≤ μ max(N, 0): the paper's words can be read either way."
            .into(),
    ];
    let sheet = Sheet { size: (2000, 860), charts, caption };
    Ok(Figure { name: "fig5a", sheet, claims, table: None })
}

/// Draws Fig. 5b of Abramian & Staron (2020): the mean overlap against the time step Δt, once on logarithmic axes, on
/// which a power law is a straight line, and once on the axes of the article. Also tests the statements of the article
/// about overlap, for example that the slump rises with Δt at large overlaps and that grains then have fewer contacts.
pub(super) fn overlap(studies: &StudyRunner) -> Result<Figure> {
    let all = studies.rows("pile")?;
    let rows = ensemble(&all);
    let y = Axis::log("mean overlap δ/d", 1e-5, 0.2);
    let of_exponent =
        chart(&all, "Fig. 5b: mean overlap during 1 s", time_steps(), y, "mean_overlap");
    let x = Axis::linear("Δt (s)", 0.0, 5.5e-3);
    let y = Axis::linear("mean overlap δ/d", 0.0, END_OF_AXIS);
    let of_paper = chart(&all, "On the paper's axes", x, y, "mean_overlap");
    let caption = vec![format!(
        "Means over {} initial states of 138 grains with 95 % intervals; thin: the one state of Fig. 4, which is in \
            no mean.",
        rows.values("seed").len()
    )];
    let sheet = Sheet { size: (2000, 860), charts: vec![of_exponent, of_paper], caption };
    let cohesive = rows.such_that(|run| run.at("bond") > 0.0);
    let claims = vec![grows(&cohesive), stays_below(&rows), reverses(&cohesive), loses(&cohesive)];
    Ok(Figure { name: "fig5b", sheet, claims, table: None })
}

fn time_steps() -> Axis {
    Axis::log("Δt (s)", 8e-5, 6.5e-3)
}

/// Draws the measured number named `reading` of all runs against Δt, with one curve per Bond number.
fn chart(rows: &Measurements<'_>, title: &str, x: Axis, y: Axis, reading: &str) -> Chart {
    let mut chart = Chart::new(title, x, y);
    let bonds = rows.values("bond");
    for (index, &bond) in bonds.iter().enumerate() {
        let of_bond = rows.with("bond", bond);
        let single = of_bond.with("seed", NewPile::default().seed as f64);
        let ensemble = ensemble(&of_bond);
        let colour = PALETTE[index % PALETTE.len()];
        let shown = single.rising(|run| (run.at("dt"), run.reading(reading)));
        let name = format!("Bond {bond}, single state");
        chart.layers.push(Layer::quiet(name, points(shown), colour, Look::Line(1)));
        let means = of_bond.values("dt").into_iter().map(|step| {
            let mean = mean(&ensemble.with("dt", step).readings(reading));
            Point { x: step, y: mean.mean, interval: Some((mean.low.max(1e-6), mean.high)) }
        });
        let name = format!("Bond {bond}");
        let curve = Layer::curve(name, means.collect(), colour, Look::LineAndDots);
        chart.layers.push(curve.beside(index, bonds.len()));
    }
    chart
}

fn slopes(groups: &[Alike]) -> Mean {
    mean(&groups.iter().map(|pairs| slope(pairs)).collect::<Vec<_>>())
}

fn measured(what: &str, mean: &Mean) -> String {
    let Mean { mean, low, high, count, .. } = mean;
    format!("{what} {mean:+.3}, 95 % interval {low:+.3} … {high:+.3}, {count} states")
        .replace('-', "−")
}

fn flat(states: &[Alike]) -> (String, Verdict) {
    let slope = slopes(states);
    let p = slope.p_within(FLAT_PER_DECADE);
    let p_not = slope.p_above(FLAT_PER_DECADE).min(slope.p_below(-FLAT_PER_DECADE));
    let measured = measured("slope per decade", &slope);
    (format!("{measured}; within ±{FLAT_PER_DECADE}: {}", p_value(p)), Verdict::of(p, p_not))
}

fn falling(states: &[Alike]) -> (String, Verdict) {
    let slope = slopes(states);
    tested(&slope, "below", slope.p_below(0.0), slope.p_above(0.0))
}

fn rising(states: &[Alike]) -> (String, Verdict) {
    let slope = slopes(states);
    tested(&slope, "above", slope.p_above(0.0), slope.p_below(0.0))
}

fn tested(slope: &Mean, side: &str, p: f64, p_not: f64) -> (String, Verdict) {
    let measured = measured("slope per decade", slope);
    (format!("{measured}; {side} 0: {}", p_value(p)), Verdict::of(p, p_not))
}

/// Tests whether the slump has a minimum as a function of Δt. For each initial state, the slumps at the smallest and at
/// the largest Δt are compared with the mean of the slumps between them; on average, both must be larger. The test does
/// not look for the Δt with the lowest slump, because such a Δt exists even without any effect of Δt.
fn minimum(states: &[Alike]) -> (String, Verdict) {
    let rise = |end: fn(&Alike) -> f64| {
        let over = |pairs: &Alike| {
            let inner = &pairs[1..pairs.len() - 1];
            end(pairs) - inner.iter().map(|(_, slump)| slump).sum::<f64>() / inner.len() as f64
        };
        mean(&states.iter().filter(|pairs| pairs.len() > 2).map(over).collect::<Vec<_>>())
    };
    let left = rise(|pairs| pairs[0].1);
    let right = rise(|pairs| pairs[pairs.len() - 1].1);
    let p = left.p_above(0.0).max(right.p_above(0.0));
    let p_not = p_of_either(left.p_below(0.0), right.p_below(0.0));
    let measured = format!(
        "{}; {}; both above 0: {}",
        measured("smallest Δt above those between", &left),
        measured("largest Δt above those between", &right),
        p_value(p)
    );
    (measured, Verdict::of(p, p_not))
}

fn grows(cohesive: &Measurements<'_>) -> Claim {
    let log_overlap = |run: &MeasuredCase| run.reading("mean_overlap").max(1e-12).log10();
    let states = groups(cohesive, log_step, log_overlap);
    let exponent = slopes(&states);
    let Mean { mean, low, high, .. } = exponent;
    Claim::new(
        "Fig. 5b: the mean overlap grows with Δt",
        format!("δ ∝ Δt^{mean:.2} over all Bond > 0, 95 % interval {low:.2} … {high:.2}"),
        Verdict::of(exponent.p_above(0.0), exponent.p_below(0.0)),
    )
    .shuffled(&states, |_| 0.0, |states| slopes(states).p_above(0.0) < SIGNIFICANT)
    .hanging_on("the states; no choice of cone or solver is known that undoes it")
}

fn stays_below(rows: &Measurements<'_>) -> Claim {
    let largest = rows.readings("mean_overlap").into_iter().fold(0.0, f64::max);
    Claim::new(
        format!("Fig. 5b: it stays below {END_OF_AXIS} d, where the paper's axis ends"),
        format!("largest mean overlap of a run {largest:.3} d"),
        (largest < END_OF_AXIS).into(),
    )
    .by_chance("nothing is drawn at random but the states: a largest value of all runs has no null hypothesis")
    .hanging_on("what counts as overlap: |gap|/d of touching grains, averaged over steps")
}

/// Returns how much steeper the slump increases with Δt at large overlaps. For each initial state and Bond number,
/// slopes are computed between neighbouring Δt. The result is the mean slope of those pairs of Δt whose larger Δt has a
/// mean overlap above [`LARGE_OVERLAP`], minus the mean slope of the other pairs. Initial states and Bond numbers that
/// only have one kind of pairs are left out.
fn turn(slumps: &[Alike], overlaps: &[Alike]) -> Mean {
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
    mean(&slumps.iter().zip(overlaps).filter_map(of_group).collect::<Vec<_>>())
}

/// Tests the explanation of Abramian & Staron (2020) that the slump begins to rise with the time step Δt when the mean
/// overlap is large.
fn reverses(cohesive: &Measurements<'_>) -> Claim {
    let slumps = groups(cohesive, log_step, |run| run.reading("slump"));
    let overlaps = groups(cohesive, log_step, |run| run.reading("mean_overlap"));
    let turning = turn(&slumps, &overlaps);
    let measured = format!(
        "slope of slump a decade of Δt, above {LARGE_OVERLAP} d less below, at the same state and Bond: {}, {} pairs; \
         above 0: {}",
        turning.signed(3),
        turning.count,
        p_value(turning.p_above(0.0))
    );
    Claim::new(
        "The paper's explanation: larger steps weaken piles where the mean overlap is above 1 %",
        measured.replace('-', "−"),
        Verdict::of(turning.p_above(0.0), turning.p_below(0.0)),
    )
    .shuffled(&slumps, |_| 0.0, |slumps| turn(slumps, &overlaps).p_above(0.0) < SIGNIFICANT)
    .hanging_on(
        "the shifted cone; and on overlap and Δt growing together: what else grows with Δt would do as well",
    )
}

/// Tests the explanation of Abramian & Staron (2020) that strongly cohesive piles have fewer contacts at larger time
/// steps Δt, and that piles with fewer contacts slump more.
fn loses(cohesive: &Measurements<'_>) -> Claim {
    let strongest = cohesive.values("bond").last().copied().unwrap_or(f64::NAN);
    let strong = &cohesive.with("bond", strongest);
    let contacts = groups(strong, log_step, |run| run.reading("mean_contacts"));
    let falls = slopes(&contacts);
    let slumps = groups(strong, log_step, |run| run.reading("slump"));
    let with = |slumps: &[Alike]| {
        let of_state = |(slumps, contacts): (&Alike, &Alike)| {
            let pairs: Vec<_> = contacts.iter().zip(slumps).map(|(c, s)| (c.1, s.1)).collect();
            slope(&pairs)
        };
        let slopes = slumps.iter().zip(&contacts).map(of_state);
        mean(&slopes.filter(|slope| slope.is_finite()).collect::<Vec<_>>())
    };
    let of_slump = with(&slumps);
    let p = falls.p_below(0.0).max(of_slump.p_below(0.0));
    let p_not = p_of_either(falls.p_above(0.0), of_slump.p_above(0.0));
    let measured = format!(
        "at the largest Bond contacts change by {:+.1} a decade of Δt ({:+.1} … {:+.1}), and slump by {:+.4} a contact \
         within a state ({:+.4} … {:+.4}); both below 0: {}",
        falls.mean,
        falls.low,
        falls.high,
        of_slump.mean,
        of_slump.low,
        of_slump.high,
        p_value(p)
    );
    Claim::new(
        "The paper's explanation: strong piles lose contacts at large Δt, and slump for it",
        measured.replace('-', "−"),
        Verdict::of(p, p_not),
    )
    .shuffled(
        &slumps,
        |_| 0.0,
        |slumps| falls.p_below(0.0).max(with(slumps).p_below(0.0)) < SIGNIFICANT,
    )
    .hanging_on("the shifted cone; which of the two is the cause is not told: a pile that spreads loses contacts, too")
}
