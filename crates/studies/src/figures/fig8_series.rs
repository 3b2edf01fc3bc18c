//! Draws Fig. 8 of Abramian & Staron (2020): the position of disc j over time in the cradle, three discs i, j and k on
//! a line, of which k hits the bonded discs i and j. Tests the statements of the article about these runs.

use std::ops::RangeInclusive;

use super::fig8::{OPEN_GAP, PHASE_SECS};
use super::{Claim, Figure, StudyRunner};
use crate::chart::{Axis, Chart, Layer, Look, PALETTE, Sheet, points};
use crate::error::{Error, Result};
use crate::scene::cradle;

/// Time steps that the figure shows, s. According to Abramian & Staron (2020), the bond of the cradle (disc k hits the
/// bonded discs i and j) opens at the first time step and stays closed at the second. At the other four, the outcome
/// depends on the start distance of disc k.
const SHOWN_SECS: [f64; 6] = [5e-4, 1e-3, 4e-3, 5e-3, 6e-3, 1e-2];
/// Upper ends of the axes in Fig. 8 of Abramian & Staron (2020): time, s, and position of the struck disc j, diameters.
const ENDS: (f64, f64) = (2.0, 5.0);
/// Range of time steps, s, at which disc j of the cradle (disc k hits the bonded discs i and j) flies off with a
/// velocity that does not depend on the time step, according to Abramian & Staron (2020).
const FREE_SECS: RangeInclusive<f64> = 1e-4..=6e-4;
/// Range of time steps, s, at which all three discs of the cradle (disc k hits the bonded discs i and j) stay together
/// after the shock, according to Abramian & Staron (2020).
const CLUSTER_SECS: RangeInclusive<f64> = 7e-4..=3e-3;
/// Time step, s, at which the bond of the cradle (disc k hits the bonded discs i and j) opens and disc i then catches
/// up with disc j, according to Abramian & Staron (2020).
const CAUGHT_SECS: f64 = 5e-3;
/// Largest ratio of the final velocities of disc j of the cradle (disc k hits the bonded discs i and j) in two runs
/// with different time steps, at which the two velocities count as equal.
const ONE_VELOCITY: f64 = 1.1;
/// Text for the report: choices on which the verdicts about the cradle (disc k hits the bonded discs i and j) depend.
const CHOICES: &str = "the start of k (searched for), ρ = 0.2 (the paper states none), the stop and the cold start: \
                       cradle-choices";

/// A row of the time series of a run of the cradle: the time since disc k first touched disc i, s, and the positions of
/// the discs i, j and k, in diameters.
type SeriesRow = (f64, [f64; 3]);

struct DiscSeries {
    step_secs: f64,
    rows: Vec<SeriesRow>,
}

/// Returns the gap between the bonded discs i and j of the cradle, in which disc k hits disc i, in diameters.
fn gap((_, [i, j, _]): &SeriesRow) -> f64 {
    j - i - 1.0
}

impl DiscSeries {
    fn after_shock(&self) -> impl DoubleEndedIterator<Item = &SeriesRow> {
        self.rows.iter().filter(|(secs, _)| *secs >= 0.0)
    }

    fn ends_open(&self) -> bool {
        self.rows.last().is_some_and(|row| gap(row) > OPEN_GAP)
    }

    /// True if disc j of the cradle (disc k hits the bonded discs i and j) has turned back: at the end of the run it is
    /// no longer at its largest distance from its start.
    fn turns_back(&self) -> bool {
        let farthest = self.after_shock().map(|(_, [_, j, _])| *j).fold(1.0, f64::max);
        self.rows.last().is_some_and(|(_, [_, j, _])| *j < farthest - OPEN_GAP)
    }

    /// Returns the mean velocity of disc j of the cradle (disc k hits the bonded discs i and j) over the last quarter
    /// of a second of the run, diameters per second.
    fn final_velocity(&self) -> f64 {
        let Some((end, [_, last, _])) = self.rows.last() else { return 0.0 };
        let before = self.after_shock().find(|(secs, _)| *secs >= end - 0.25);
        before.map_or(0.0, |(secs, [_, j, _])| (last - j) / (end - secs))
    }
}

pub(super) fn make(studies: &StudyRunner) -> Result<Figure> {
    let diameter = cradle().mean_diameter;
    let mut runs = Vec::new();
    for (config, text) in studies.series("cradle-courses")? {
        let step_secs = config.parameters.time_step_secs.unwrap_or(0.0);
        runs.push(DiscSeries { step_secs, rows: read(&text, diameter)? });
    }
    let mut near = chart(&runs, "place of j after the shock", -0.1, 0.8)?;
    let curves = near.layers.iter().filter_map(|layer| match layer {
        Layer::Curve { points, .. } => Some(points),
        _ => None,
    });
    let highest = curves.flatten().map(|point| point.y).fold(1.1, f64::max);
    (near.y.from, near.y.to) = (1.0 - 0.05 * (highest - 1.0), 1.0 + 1.05 * (highest - 1.0));
    let mut far = chart(&runs, "the same on the paper's axes", 0.0, ENDS.0)?;
    (far.y.from, far.y.to) = (0.0, ENDS.1);
    let caption = vec![
        "k starts 7.865 d left of i: a distance that was searched for, as the paper does not tell \
        its own."
            .into(),
    ];
    let sheet = Sheet { size: (2000, 860), charts: vec![near, far], caption };
    let claims = vec![swings(&runs), caught(&runs), cluster(&runs), one_velocity(&runs)];
    let claims = claims.into_iter().map(|claim| claim.hanging_on(CHOICES)).collect();
    Ok(Figure { name: "fig8", sheet, claims, table: None })
}

fn chart(runs: &[DiscSeries], title: &str, from: f64, to: f64) -> Result<Chart> {
    let axes = (Axis::linear("t − t_shock (s)", from, to), Axis::linear("x_j / d", 0.98, 1.2));
    let mut chart = Chart::new(format!("Fig. 8: {title}"), axes.0, axes.1);
    for (index, shown) in SHOWN_SECS.into_iter().enumerate() {
        let run = runs.iter().find(|run| run.step_secs == shown);
        let run = run.ok_or_else(|| Error::value("dt", shown, "part of the study"))?;
        let places = run.rows.iter().map(|(secs, [_, j, _])| (*secs, *j));
        let places = points(places.filter(|(secs, j)| (from..=to).contains(secs) && *j <= ENDS.1));
        let name = format!("Δt = {shown:e} s").replace('-', "−");
        // As long as the bond is closed in both runs, the curve of this time step coincides with the curve of 1e-3 s.
        // Dashes keep both curves visible.
        let look = if shown == CAUGHT_SECS { Look::Dashes(3) } else { Look::Line(3) };
        chart.layers.push(Layer::curve(name, places, PALETTE[index], look));
    }
    Ok(chart)
}

fn read(text: &str, diameter: f64) -> Result<Vec<SeriesRow>> {
    let refuse = |error: csv::Error| Error::file("series", error);
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let headers = reader.headers().map_err(refuse)?.clone();
    let column = |name: &str| {
        let missing = || format!("has no column {name}, but must be as this version writes series");
        let found = headers.iter().position(|header| header == name);
        found.ok_or_else(|| Error::file("series", missing()))
    };
    let columns = [column("time")?, column("x0")?, column("x1")?, column("x2")?];
    let mut rows: Vec<SeriesRow> = Vec::new();
    for record in reader.records() {
        let record = record.map_err(refuse)?;
        let [secs, i, j, k] = columns.map(|index| {
            record.get(index).and_then(|cell| cell.parse::<f64>().ok()).unwrap_or(0.0)
        });
        rows.push((secs, [i, j, k].map(|place| place / diameter)));
    }
    // The shock is at the first row in which k is within a hundredth of a diameter of i. The contact itself can fall
    // between two rows, because it is shorter than their distance in time.
    let shock_secs = rows.iter().find(|(_, [i, _, k])| i - k <= 1.01).map_or(0.0, |row| row.0);
    rows.iter_mut().for_each(|row| row.0 -= shock_secs);
    Ok(rows)
}

/// Returns the runs whose time step Δt, s, is in a closed interval.
fn between(runs: &[DiscSeries], steps: RangeInclusive<f64>) -> impl Iterator<Item = &DiscSeries> {
    runs.iter().filter(move |run| steps.contains(&run.step_secs))
}

fn swings(runs: &[DiscSeries]) -> Claim {
    let agree = runs.iter().filter(|one| one.turns_back() != one.ends_open()).count();
    let closed = runs.iter().filter(|one| !one.ends_open()).count();
    let ways = statrs::function::factorial::binomial(runs.len() as u64, closed as u64);
    Claim::new(
        "Fig. 8: where the bond holds j swings back with i, and where it is lost j goes on",
        format!(
            "so in {agree} of {} runs; in {closed} of them the bond holds at the end",
            runs.len()
        ),
        (agree == runs.len()).into(),
    )
    .by_chance(format!("in 1 of {ways:.0} ways to choose {closed} of {} runs", runs.len()))
}

fn caught(runs: &[DiscSeries]) -> Claim {
    let said = "§4: at Δt = 5·10⁻³ s the bond opens and i catches up with j";
    let Some(run) = runs.iter().find(|run| run.step_secs == CAUGHT_SECS) else {
        return Claim::new(said, "no run", false.into());
    };
    let open = |row: &&SeriesRow| gap(row) > OPEN_GAP;
    let widest = run.after_shock().map(gap).fold(0.0, f64::max);
    let (first, last) = (run.after_shock().find(open), run.after_shock().rev().find(open));
    let measured = match (first, last) {
        (Some(first), Some(last)) => format!(
            "i and j are up to {:.4} d apart, from {:.3} to {:.3} s after the shock",
            widest, first.0, last.0
        ),
        _ => "i and j are never apart".to_owned(),
    };
    let holds = widest > OPEN_GAP && !run.ends_open();
    let phase = format!(
        "at Δt ≥ {PHASE_SECS} s the outcome is a matter of phase: fig8-share has how often"
    );
    Claim::new(said, measured, holds.into()).by_chance(phase.replace("0.0035", "3.5·10⁻³"))
}

fn cluster(runs: &[DiscSeries]) -> Claim {
    let ends: Vec<f64> = between(runs, CLUSTER_SECS)
        .filter_map(|run| run.rows.last())
        .map(|(_, [i, _, k])| i - k - 1.0)
        .collect();
    let apart = ends.iter().filter(|gap| **gap > OPEN_GAP).count();
    let [least, most] = [f64::min, f64::max].map(|pick| ends.iter().copied().fold(ends[0], pick));
    Claim::new(
        "§4: at Δt = 7·10⁻⁴…3·10⁻³ s all three discs stay together",
        format!(
            "k is apart from i at the end in {apart} of {} runs, by {least:.3} … {most:.3} d; the outcomes told of the \
             bond are those of i and j alone",
            ends.len()
        ),
        (apart == 0).into(),
    )
    .by_chance("nothing is drawn at random: one start, four time steps")
}

fn one_velocity(runs: &[DiscSeries]) -> Claim {
    let velocities: Vec<(f64, f64)> =
        between(runs, FREE_SECS).map(|run| (run.step_secs, run.final_velocity())).collect();
    let [least, most] = [f64::min, f64::max]
        .map(|pick| velocities.iter().map(|(_, velocity)| *velocity).fold(velocities[0].1, pick));
    let listed: Vec<String> =
        velocities.iter().map(|(step, velocity)| format!("{velocity:.3} at {step:e}")).collect();
    Claim::new(
        "Fig. 8: at Δt = 1…6·10⁻⁴ s j leaves with one velocity, whatever Δt is",
        format!(
            "{} (d/s, Δt in s); the largest is {:.2} times the smallest, and {ONE_VELOCITY} would count as one",
            listed.join(", "),
            most / least
        )
            .replace('-', "−"),
        (least > 0.0 && most <= ONE_VELOCITY * least).into(),
    )
    .by_chance("nothing is drawn at random: one start, six time steps")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_series_without_a_column_is_refused() {
        let rows = "0,0.5,3,0,2,0,1,0\n";
        let of = |names: &str| read(&format!("{names}\n{rows}"), 1.0);
        let read = of("step,time,x0,y0,x1,y1,x2,y2").expect("a series");
        assert_eq!(read, [(0.5, [3.0, 2.0, 1.0])]);
        let refused = of("step,time_secs,x0,y0,x1,y1,x2,y2").expect_err("no time").to_string();
        assert_eq!(
            refused,
            "series: has no column time, but must be as this version writes series"
        );
    }
}
