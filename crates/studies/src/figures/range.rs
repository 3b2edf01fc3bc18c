//! The law `range` beside the paper's: slump against Δt under both, slump against Bond under `range`
//! at all Δt, and what a simulated second costs at which error.

use std::time::Instant;

use super::claims::{Claim, SIGNIFICANT, Verdict};
use super::comparison::PairedSlumps;
use super::studies::Rows;
use super::{Figure, StudyRunner, slump_point};
use crate::chart::{Axis, Chart, Layer, LegendCorner, Look, PALETTE, Point, Sheet};
use crate::config::SceneSource;
use crate::error::Result;
use crate::report::ReportTable;
use crate::sim::Stepper;
use crate::statistics::{mean, p_value};

/// The steppers whose laws are compared.
const LAWS: [Stepper; 2] = [Stepper::Moreau, Stepper::Range];

/// Bonds whose curves against Δt are drawn.
const SHOWN_BONDS: [f64; 5] = [0.0, 10.0, 15.0, 20.0, 100.0];

/// A mean overlap that no run is to pass, in diameters.
const MOST_OVERLAP: f64 = 1e-3;

/// The run that is timed, s of simulated time at this Bond.
const TIMED: (f64, f64) = (0.3, 20.0);

pub(super) fn make(studies: &StudyRunner) -> Result<Figure> {
    let rows = studies.rows("range")?;
    let of_law = LAWS.map(|law| rows.such_that(|config| config.stepper == Some(law)));
    let steps = rows.steps();
    let mut charts: Vec<Chart> = LAWS
        .iter()
        .zip(&of_law)
        .map(|(law, rows)| against_step(law.name(), rows, &steps))
        .collect();
    charts.push(against_bond(&of_law[1], &steps));
    charts.push(cost(&of_law, &steps, studies.quick)?);
    let caption = vec![format!(
        "Means over {} initial states of 138 grains with 95 % intervals. Error: mean over the Bonds of the \
         difference of slump from that at Δt = {:e} s; a dot for each larger Δt.",
        rows.seeds().len(),
        steps[0]
    )];
    let sheet = Sheet { size: (2000, 760), charts, caption };
    let named = [(LAWS[0].name(), &of_law[0]), (LAWS[1].name(), &of_law[1])];
    let mut claims = Vec::from(named.map(|(name, rows)| no_dependence(name, rows, &steps)));
    let overlaps = of_law[1].results(|result| result.tally.mean_overlap);
    let largest = overlaps.into_iter().fold(0.0, f64::max);
    claims.push(Claim::new(
        format!("Beyond the paper: under range the mean overlap stays below {MOST_OVERLAP} d"),
        format!("largest mean overlap of a run {largest:.1e} d").replace("e-", "e−"),
        (largest < MOST_OVERLAP).into(),
    ));
    Ok(Figure { name: "range", sheet, claims, table: Some(table(&named, &steps)) })
}

/// Those of the values that lie on an axis: the panels are too narrow for more.
fn ticks(values: &[f64], from: f64, to: f64) -> Vec<(f64, String)> {
    let written = |value: f64| {
        let plain = if value < 1e-2 { format!("{value:e}") } else { value.to_string() };
        (value, plain.replace('-', "−"))
    };
    let on_axis = values.iter().copied().filter(|value| (from..=to).contains(value));
    on_axis.map(written).collect()
}

fn against_step(law: &str, rows: &Rows<'_>, steps: &[f64]) -> Chart {
    let x = Axis::log("Δt (s)", 0.8 * steps[0], 1.3 * steps[steps.len() - 1]);
    let x = Axis { ticks: ticks(&[2e-4, 1e-3, 5e-3], steps[0], steps[steps.len() - 1]), ..x };
    let mut chart = Chart::new(format!("Law {law}"), x, Axis::linear("slump Δy_G", 0.0, 0.7));
    let bonds = rows.bonds();
    let shown = bonds.into_iter().filter(|bond| SHOWN_BONDS.contains(bond));
    for (index, bond) in shown.enumerate() {
        let means =
            steps.iter().map(|&step| slump_point(step, &rows.of_bond(bond).of_step(step).slumps()));
        let colour = PALETTE[index % PALETTE.len()];
        let curve =
            Layer::curve(format!("Bond {bond}"), means.collect(), colour, Look::LineAndDots);
        chart.layers.push(curve.beside(index, SHOWN_BONDS.len()));
    }
    chart
}

fn against_bond(rows: &Rows<'_>, steps: &[f64]) -> Chart {
    let bonds = rows.bonds();
    let most = bonds[bonds.len() - 1];
    let x = Axis::linear("Bond", -0.03 * most, 1.05 * most);
    let y = Axis::linear("slump Δy_G", 0.0, 0.7);
    let mut chart = Chart::new("Law range, every Δt", x, y);
    for (index, &step) in steps.iter().enumerate() {
        let means =
            bonds.iter().map(|&bond| slump_point(bond, &rows.of_bond(bond).of_step(step).slumps()));
        let colour = PALETTE[index % PALETTE.len()];
        let name = format!("Δt {step:e} s").replace("e-", "e−");
        let curve = Layer::curve(name, means.collect(), colour, Look::LineAndDots);
        chart.layers.push(curve.beside(index, steps.len()));
    }
    chart
}

/// Wall-clock seconds of one thread for a simulated second against the error, a point a Δt.
fn cost(of_law: &[Rows<'_>; 2], steps: &[f64], quick: bool) -> Result<Chart> {
    let mut curves = Vec::new();
    for (law, rows) in LAWS.into_iter().zip(of_law) {
        let bonds = rows.bonds();
        let mut points = Vec::new();
        for &step in &steps[1..] {
            let differences = bonds.iter().map(|&bond| {
                let at = |step| mean(&rows.of_bond(bond).of_step(step).slumps()).mean;
                (at(step) - at(steps[0])).abs()
            });
            let error = differences.sum::<f64>() / bonds.len() as f64;
            let secs = seconds_per_second(rows, law, step, quick)?;
            points.push(Point { x: error, y: secs, interval: None });
        }
        curves.push((law.name(), points));
    }
    let all = || curves.iter().flat_map(|(_, points)| points);
    let span = |number: fn(&Point) -> f64, room: f64| {
        let numbers = || all().map(number).filter(|number| *number > 0.0);
        let low = numbers().fold(f64::INFINITY, f64::min);
        (low / room, numbers().fold(0.0, f64::max) * room)
    };
    let ((left, right), (low, high)) = (span(|point| point.x, 1.5), span(|point| point.y, 2.0));
    let x = Axis::log("error of the slump", left, right);
    let x = Axis { ticks: ticks(&[3e-3, 1e-2, 3e-2, 1e-1], left, right), ..x };
    let mut chart =
        Chart::new("Cost at equal error", x, Axis::log("seconds per simulated second", low, high));
    chart.legend = LegendCorner::UpperRight;
    for ((name, points), colour) in curves.into_iter().zip([PALETTE[6], PALETTE[1]]) {
        chart.layers.push(Layer::curve(name, points, colour, Look::Dots(6)));
    }
    Ok(chart)
}

/// Times one state of the study.
fn seconds_per_second(rows: &Rows<'_>, law: Stepper, step: f64, quick: bool) -> Result<f64> {
    let (duration, bond) = TIMED;
    let like = rows.of_step(step);
    let Some((config, _)) = like.0.first() else { return Ok(f64::NAN) };
    // The state that is shipped: no pile is settled for this.
    let mut config = (*config).clone();
    config.source = SceneSource { seed: None, duration: Some(duration), ..config.source };
    config.parameters.bond = Some(bond);
    config.stepper = Some(law);
    let scene = config.without_settling()?;
    let mut least = f64::INFINITY;
    for _ in 0..if quick { 1 } else { 3 } {
        let mut simulation = scene.simulation()?;
        let begun = Instant::now();
        while simulation.time_secs() < duration {
            simulation.step()?;
        }
        least = least.min(begun.elapsed().as_secs_f64());
    }
    Ok(least / duration)
}

/// Every Bond at every Δt of `steps`, which rise, against the same Bond at the first of them.
fn compare(rows: &Rows<'_>, steps: &[f64]) -> Vec<PairedSlumps> {
    let of_bond = |bond: f64| {
        let here = rows.of_bond(bond);
        let least = here.of_step(steps[0]);
        let pairs =
            steps.iter().map(|&step| PairedSlumps::at(bond, step, &least, &here.of_step(step)));
        pairs.collect::<Vec<_>>()
    };
    rows.bonds().into_iter().flat_map(of_bond).collect()
}

/// That slump does not depend on Δt under a law. With many comparisons some differ by chance, so p-values are
/// multiplied by their number (Bonferroni).
fn no_dependence(law: &str, rows: &Rows<'_>, steps: &[f64]) -> Claim {
    let mut all = compare(rows, steps);
    all.retain(|one| one.step != steps[0]);
    let outside: Vec<_> = all
        .iter()
        .filter(|one| one.differs())
        .map(|one| format!("{} ({:+.3})", one.name, one.difference.mean))
        .collect();
    let least = all.iter().map(|one| one.difference.p_not_zero()).fold(1.0, f64::min);
    let widest = all.iter().map(|one| one.difference.mean.abs()).fold(0.0, f64::max);
    let p = (least * all.len() as f64).min(1.0);
    let measured = format!(
        "{} of {} means outside the 95 % interval about that at {:e} s{}{}; largest difference {widest:.3}; any \
         difference: {}; {} states",
        outside.len(),
        all.len(),
        steps[0],
        if outside.is_empty() { "" } else { ": " },
        outside.join(", "),
        p_value(p),
        rows.seeds().len()
    );
    let verdict = match (p < SIGNIFICANT, outside.is_empty()) {
        (true, _) => Verdict::Fails,
        (false, true) => Verdict::Holds,
        (false, false) => Verdict::Open,
    };
    let said = format!("Beyond the paper: under {law} the slump does not depend on Δt");
    Claim::new(said, measured.replace('-', "−"), verdict)
}

/// The verdict on each Bond and Δt, law by law.
fn table(laws: &[(&str, &Rows<'_>)], steps: &[f64]) -> ReportTable {
    let columns = ["law", "bond", "dt", "states", "slump", "half_interval"];
    let of_difference = ["difference", "difference_low", "difference_high", "agrees"];
    let number = |value: f64| format!("{value:.4}");
    let mut rows = Vec::new();
    for (law, of_law) in laws {
        for one in compare(of_law, steps) {
            let PairedSlumps { bond, step, other: slump, difference, .. } = &one;
            let mut row = vec![
                (*law).to_owned(),
                bond.to_string(),
                format!("{step:e}"),
                slump.count.to_string(),
                number(slump.mean),
                number(slump.high - slump.mean),
            ];
            if *step == steps[0] {
                row.extend(["", "", "", "reference"].map(str::to_owned));
            } else {
                row.extend([difference.mean, difference.low, difference.high].map(number));
                row.push(if one.differs() { "no" } else { "yes" }.to_owned());
            }
            rows.push(row);
        }
    }
    ReportTable { name: "range-agreement", columns: [&columns[..], &of_difference].concat(), rows }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::RunResult;
    use crate::config::Config;

    #[test]
    fn a_shift_beyond_the_interval_is_told_and_one_within_is_not() {
        const STEPS: [f64; 3] = [1e-4, 1e-3, 1e-2];
        let shifts = [0.0, 0.02, -0.1];
        let mut runs = Vec::new();
        for (step, shift) in STEPS.into_iter().zip(shifts) {
            for seed in 1..=6u64 {
                // States differ by far more than what a shift is measured against.
                let scatter =
                    if step == STEPS[0] { 0.0 } else { 0.03 * [1.0, -1.0][seed as usize % 2] };
                let slump = 0.1 * seed as f64 + shift + scatter;
                let mut config = Config::default();
                config.source.seed = Some(seed);
                config.parameters.bond = Some(10.0);
                config.parameters.time_step_secs = Some(step);
                runs.push((config, RunResult::of_slump(slump)));
            }
        }
        let rows = Rows(runs.iter().map(|(config, result)| (config, result)).collect());
        let table = table(&[("range", &rows)], &STEPS);
        let verdicts: Vec<_> = table.rows.iter().map(|row| row.last().unwrap().as_str()).collect();
        assert_eq!(verdicts, ["reference", "yes", "no"]);
        let claim = no_dependence("range", &rows, &STEPS);
        assert_eq!(claim.verdict, Verdict::Fails, "{}", claim.measured);
        assert!(claim.measured.contains("Bond 10 at 1e−2 s (−0.100)"), "{}", claim.measured);
        assert!(!claim.measured.contains("1e−3"), "{}", claim.measured);
        assert!(table.to_markdown().lines().count() == 2 + STEPS.len());
    }
}
