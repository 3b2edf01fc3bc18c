//! Draws the outcomes of the cradle of Abramian & Staron (2020): three discs i, j and k on a line. Disc k hits disc i,
//! and this shock may open the bond between i and j. The figures show at which time steps Δt the bond opens, the
//! fraction of open bonds over many start distances of k, and a map of the outcome over Δt and the stopping tolerance
//! of the solver.

use super::claims::{Claim, Verdict};
use super::{Figure, StudyRunner};
use crate::chart::{Axis, Chart, INK, Layer, Look, MapCell, PALETTE, Point, Rgb, Sheet, points};
use crate::error::Result;
use crate::harness::{MeasuredCase, Measurements, ReportTable};
use crate::scene::cradle;
use crate::statistics;

/// Gap between the bonded discs i and j of the cradle at the end of a run, in diameters, above which their bond counts
/// as open. The value is well above rounding errors, and well below any gap of an open bond.
pub(super) const OPEN_GAP: f64 = 1e-6;
/// Time steps, s, at which the bond of the cradle opens after Abramian & Staron (2020): disc k hits the bonded discs i
/// and j.
const OPEN_SECS: [f64; 9] = [1e-4, 2e-4, 3e-4, 4e-4, 5e-4, 6e-4, 4e-3, 6e-3, 1e-2];
/// Time steps, s, at which the bond of the cradle stays closed after Abramian & Staron (2020).
const CLOSED_SECS: [f64; 5] = [7e-4, 8e-4, 1e-3, 3e-3, 5e-3];
/// Number of outcomes of the cradle (bond open or closed) that Abramian & Staron (2020) report.
const OUTCOMES: usize = OPEN_SECS.len() + CLOSED_SECS.len();
/// Time step, s, below which the outcome of the cradle (disc k hits two bonded discs, whose bond opens or stays closed)
/// does not depend on the start distance of disc k. At larger time steps the outcome depends on the time within a step
/// at which the discs meet, and therefore on this distance.
pub(super) const PHASE_SECS: f64 = 3.5e-3;

fn is_open(run: &MeasuredCase) -> bool {
    run.reading("first_gap") > OPEN_GAP
}

/// Returns the number of runs of the cradle in which the bond of the two struck discs is open at the end, and the
/// number of all runs.
fn open_of(rows: &Measurements<'_>) -> [usize; 2] {
    [rows.0.iter().filter(|run| is_open(run)).count(), rows.0.len()]
}

/// Returns the number of time steps at which the runs of the cradle (disc k hits the bonded discs i and j) have the
/// outcome that Abramian & Staron (2020) report: bond between i and j open, or closed. There is one run per time step.
fn agreed(rows: &Measurements<'_>) -> usize {
    let has = |step: f64, open: bool| {
        rows.0.iter().any(|run| run.at("dt") == step && is_open(run) == open)
    };
    let open = OPEN_SECS.iter().filter(|step| has(**step, true)).count();
    open + CLOSED_SECS.iter().filter(|step| has(**step, false)).count()
}

/// Draws how sensitive the outcomes of the cradle (disc k hits the bonded discs i and j; Fig. 8 of Abramian & Staron
/// (2020)) are to the settings: the time steps Δt at which the bond opens or stays closed, with one setting changed at
/// a time.
pub(super) fn choices(studies: &StudyRunner) -> Result<Figure> {
    let rows = studies.rows("cradle-choices")?;
    let all = studies.choices("cradle-choices")?;
    let mut y = Axis::linear("", -(all.len() as f64), 1.0);
    y.ticks = (0..).zip(&all).map(|(row, (name, _))| (-f64::from(row), name.clone())).collect();
    let x = Axis::log("Δt (s)", 8e-5, 1.3e-2);
    let mut chart = Chart::new("The bond of i and j with one choice changed", x, y);
    for (name, open, colour, look) in
        [("open", true, PALETTE[6], Look::Dots(7)), ("closed", false, PALETTE[1], Look::Rings(7))]
    {
        let of_row = |(row, (_, rows)): (i32, &(String, Measurements<'_>))| {
            let here = rows.such_that(|run| is_open(run) == open);
            here.points(|run| (run.at("dt"), -f64::from(row)))
        };
        let places = (0..).zip(&all).flat_map(of_row);
        chart.layers.push(Layer::curve(name, points(places), colour, look));
    }
    let caption =
        "The first row is that of Fig. 8; each other differs from it in what it is named for.";
    let sheet = Sheet { size: (1400, 900), charts: vec![chart], caption: vec![caption.into()] };
    let agreed = all.iter().map(|(name, rows)| vec![name.clone(), agreed(rows).to_string()]);
    let agreed: Vec<Vec<String>> = agreed.collect();
    let listed: Vec<_> = agreed.iter().map(|row| row.join(": ")).collect();
    let all_agree = agreed.iter().all(|row| row[1] == OUTCOMES.to_string());
    let claim = Claim::new(
        "§4: the pattern of open and closed bonds comes out whatever is chosen",
        format!("of {} outcomes {}", OUTCOMES, listed.join("; ")),
        all_agree.into(),
    )
    .by_chance(
        "nothing is drawn at random: a run a choice and time step; fig8-share has many starts",
    )
    .hanging_on("the choices that were tried, one at a time");
    let table = ReportTable::new("cradle-choices-outcomes", "choice of_14_outcomes", agreed);
    let claims = vec![pattern_comes_out(&all[0].1), shock_opens(&rows), claim];
    Ok(Figure { name: "cradle-choices", sheet, claims, table: Some(table) })
}

/// Tests whether the cradle (disc k hits the bonded discs i and j) gives the outcomes that Abramian & Staron (2020)
/// report at all time steps Δt, for most start distances of disc k. An outcome is the bond between i and j open or
/// closed. The test uses the runs with the largest stopping tolerance of the study.
fn pattern_is_usual(rows: &Measurements<'_>) -> Claim {
    let loosest = rows.values("tolerance").pop().unwrap_or(f64::NAN);
    let rows = rows.with("tolerance", loosest);
    let starts = rows.values("start");
    let whole = |start: &&f64| agreed(&rows.with("start", **start)) == OUTCOMES;
    let whole = starts.iter().filter(whole).count();
    let (share, low, high) = statistics::share(whole, starts.len());
    let [share, low, high] = [share, low, high].map(|share| 100.0 * share);
    Claim::new(
        "§4: the pattern of fourteen outcomes is that of most start distances",
        format!("all fourteen at {whole} of {} start distances: {share:.1} % ({low:.1} … {high:.1})", starts.len()),
        match (low > 50.0, high < 50.0) {
            (true, _) => Verdict::Holds,
            (_, true) => Verdict::Fails,
            _ => Verdict::Open,
        },
    )
    .by_chance("95 % intervals of Clopper and Pearson: wrong on one side in at most 2.5 % of studies")
    .hanging_on("start distances spread evenly from 6 to 8.5 d; the stop of 2.2·10⁻³ m/s, ρ = 0.2, the cold start")
}

fn pattern_comes_out(rows: &Measurements<'_>) -> Claim {
    let agreed = agreed(rows);
    Claim::new(
        "§4: open at Δt = 1…6·10⁻⁴ s, closed at 7·10⁻⁴…3·10⁻³, open at 4·10⁻³, closed at 5·10⁻³, open at 6·10⁻³ and \
            10⁻²",
        format!(
            "{agreed} of {} of these outcomes, from a start distance that was searched for",
            OUTCOMES
        ),
        (agreed == OUTCOMES).into(),
    )
    .by_chance("at as many start distances as fig8-share says: this one was found by a search")
    .hanging_on("that search, the stop of 2.2·10⁻³ m/s, ρ = 0.2 (the paper states none), the cold start")
}

/// Tests the statement of Abramian & Staron (2020) that the shock opens the bond of the cradle (disc k hits the bonded
/// discs i and j) at small time steps. The test uses the runs with the smallest stopping tolerance of the study.
fn shock_opens(rows: &Measurements<'_>) -> Claim {
    let tolerance = rows.values("tolerance")[0];
    let tight = rows.with("tolerance", tolerance);
    let [opened, _] = open_of(&tight.such_that(|run| run.at("dt") < PHASE_SECS));
    Claim::new(
        "§4 (eq. 15): at small Δt the shock opens the bond",
        format!(
            "solved to {tolerance:e} m/s, {opened} bonds open at Δt < {PHASE_SECS} s: the opening is what the loose stop leaves over"
        ),
        if opened == 0 { Verdict::Fails } else { Verdict::Open },
    )
    .by_chance("nothing is drawn at random: one start, a run a time step; fig8-share has many starts")
    .hanging_on("no choice of start, of those in fig8-share")
}

pub(super) fn share(studies: &StudyRunner) -> Result<Figure> {
    let rows = studies.rows("cradle-share")?;
    let mut chart = Chart::new(
        "Share of runs that lose the bond",
        Axis::log("Δt (s)", 8e-5, 1.3e-2),
        Axis::linear("share of start distances", -0.02, 1.02),
    );
    let starts = rows.values("start");
    let mut at_large_steps = Vec::new();
    let tolerances = rows.values("tolerance");
    for (&tolerance, colour) in tolerances.iter().rev().zip([PALETTE[6], PALETTE[2], PALETTE[1]]) {
        let rows = rows.with("tolerance", tolerance);
        let share = |step: f64| {
            let [hits, count] = open_of(&rows.with("dt", step));
            let (share, low, high) = statistics::share(hits, count);
            Point { x: step, y: share, interval: Some((low, high)) }
        };
        let shares: Vec<Point> = rows.values("dt").into_iter().map(share).collect();
        let large: Vec<Point> =
            shares.iter().copied().filter(|point| point.x > PHASE_SECS).collect();
        at_large_steps.push((tolerance, large));
        let name = format!("stop at {tolerance:e} m/s").replace('-', "−");
        chart.layers.push(Layer::curve(name, shares, colour, Look::LineAndDots));
    }
    let mut sheet = Sheet::of(chart);
    sheet.caption = vec![format!(
        "{} start distances of k between {} and {} d a point; 95 % intervals of Clopper and Pearson.",
        starts.len(),
        starts[0],
        starts[starts.len() - 1]
    )];
    let claims = at_large_steps.into_iter().map(|(tolerance, large)| {
        let listed: Vec<String> =
            large.iter().map(|point| format!("{:.0} % at {}", 100.0 * point.y, point.x)).collect();
        // The claim counts as true if the interval at the largest tested time step is above the interval at the
        // smallest one.
        let ends = large.first().zip(large.last());
        let intervals = ends.and_then(|(first, last)| first.interval.zip(last.interval));
        let rises = intervals.is_some_and(|(first, last)| last.0 > first.1);
        Claim::new(
            format!("Beyond the paper: at Δt ≥ 4·10⁻³ s, stopped at {tolerance:e} m/s, the share of lost bonds \
                rises with Δt"),
            format!("{} s", listed.join(", ")),
            rises.into(),
        )
        .by_chance("two intervals of 95 % lie apart in this order in at most 0.25 % of studies without an effect")
        .hanging_on("start distances spread evenly from 6 to 8.5 d; ρ = 0.2; the cold start")
    });
    let claims = claims.chain([pattern_is_usual(&rows)]).collect();
    Ok(Figure { name: "fig8-share", sheet, claims, table: None })
}

/// Returns the colour of an outcome of the cradle, in which a disc hits two bonded discs: orange if their bond is open
/// (`value` 1), blue if their bond is closed (0).
fn colour(value: f64) -> Rgb {
    if value > 0.5 { (240, 176, 80) } else { (70, 120, 175) }
}

/// Returns the two edges of each cell of a map along a logarithmic axis. The cells are centred at `values`, which have
/// a constant ratio. Neighbouring cells share their edge exactly, so that no gap is drawn between them.
pub(super) fn log_edges(values: &[f64]) -> Vec<[f64; 2]> {
    let half = match values {
        [first, second, ..] => (second / first).sqrt(),
        _ => 1.1,
    };
    let mut edges = vec![values.first().map_or(1.0, |first| first / half)];
    edges.extend(values.windows(2).map(|pair| (pair[0] * pair[1]).sqrt()));
    edges.extend(values.last().map(|last| last * half));
    edges.windows(2).map(|pair| [pair[0], pair[1]]).collect()
}

/// Draws a map of the outcome of the cradle (disc k hits the bonded discs i and j, whose bond opens or stays closed)
/// over the time step and the solver's stopping tolerance.
pub(super) fn map(studies: &StudyRunner) -> Result<Figure> {
    let rows = studies.rows("cradle-map")?;
    let (steps, tolerances) = (rows.values("dt"), rows.values("tolerance"));
    let (step_edges, tolerance_edges) = (log_edges(&steps), log_edges(&tolerances));
    let mut cells = Vec::new();
    for (&step, &step_edges) in steps.iter().zip(&step_edges) {
        for (&tolerance, &edges) in tolerances.iter().zip(&tolerance_edges) {
            let here = rows.with("dt", step).with("tolerance", tolerance);
            let of_run = |run: &&MeasuredCase| MapCell {
                x: (step, step_edges),
                y: (tolerance, edges),
                value: f64::from(u8::from(is_open(run))),
            };
            cells.extend(here.0.iter().map(of_run));
        }
    }
    let ends = |edges: &[[f64; 2]]| (edges[0][0], edges[edges.len() - 1][1]);
    let (x, y) = (ends(&step_edges), ends(&tolerance_edges));
    let mut chart = Chart::new(
        "The cradle's bond: open (orange) or closed (blue)",
        Axis::log("Δt (s)", x.0, x.1),
        Axis::log("stopping tolerance Σ|ΔP|/m (m/s)", y.0, y.1),
    );
    let small = rows.such_that(|run| run.at("dt") < 3e-3);
    let of_small = |low: f64, high: f64| {
        let [open, count] =
            open_of(&small.such_that(|run| (low..high).contains(&run.at("tolerance"))));
        open as f64 / count.max(1) as f64
    };
    let (tight, loose) = (of_small(0.0, 1e-4), of_small(1e-3, 1.0));
    chart.layers.push(Layer::Cells { name: "open".into(), cells, colour });
    // The line shows the capture speed Bond·g·Δt, the largest opening speed that one step of cohesion stops. Below the
    // line, cohesion cancels the error that the stopping tolerance allows.
    let scene = cradle();
    let capture = scene.parameters.bond * scene.gravity.magnitude();
    let line = [x.0, x.1].map(|step| (step, (capture * step).clamp(y.0, y.1)));
    chart.layers.push(Layer::curve("Bond·g·Δt", points(line), INK, Look::Dashes(3)));
    let mut sheet = Sheet::of(chart);
    sheet.size = (1200, 960);
    sheet.caption =
        vec![format!("{} × {} runs; k starts 7.865 d left of i.", steps.len(), tolerances.len())];
    let claim = Claim::new(
        "Beyond the paper: at small Δt the outcome hangs on how well the step is solved",
        format!(
            "at Δt < 3·10⁻³ s {:.0} % of bonds open at tolerances below 10⁻⁴ m/s, {:.0} % above 10⁻³",
            100.0 * tight,
            100.0 * loose
        ),
        (loose > tight + 0.1).into(),
    );
    Ok(Figure { name: "cradle-map", sheet, claims: vec![claim], table: None })
}
