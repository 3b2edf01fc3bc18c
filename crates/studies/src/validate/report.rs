//! Presents the results of the comparison with publications in words, as a table and as a figure.

use std::fmt::Write as _;

use super::experiment::{Agreement, PublishedQuantity};
use super::runs::ExperimentRuns;
use super::variants::{SolveBudget, StepVariant};
use crate::chart::{Axis, Chart, INK, Layer, Look, PALETTE, Rgb, Sheet, points};
use crate::harness::{Effort, ReportTable, distinct};
use crate::statistics::mean;

const LEAST_ERROR: f64 = 1e-3;
const MOST_ERROR: f64 = 2.0;

fn short(number: f64) -> String {
    if !number.is_finite() {
        return "none".into();
    }
    let digits = if number.abs() < 10.0 { 3 } else { 1 };
    format!("{number:.digits$}").replace('-', "−")
}

fn ends(low: f64, high: f64) -> String {
    match (low.is_finite(), high.is_finite()) {
        (false, false) => "none".into(),
        (false, true) => format!("at most {}", short(high)),
        (true, false) => format!("at least {}", short(low)),
        (true, true) => format!("{} … {}", short(low), short(high)),
    }
}

pub(super) fn table(all: &[ExperimentRuns]) -> ReportTable {
    let mut rows = Vec::new();
    for runs in all {
        for (quantity, verdict) in runs.judged() {
            let PublishedQuantity { name, system, published, band, kind, source, measured } =
                &quantity;
            let [low, high] = *band;
            let numbers = [*published, low, high, measured.mean, measured.low, measured.high];
            let mut row = vec![runs.experiment.name.to_owned(), runs.words(), (*name).to_owned()];
            row.extend([system.clone(), (*source).to_owned(), kind.words().to_owned()]);
            row.extend(numbers.map(|number| number.to_string()));
            row.extend([measured.count.to_string(), verdict.words().to_owned()]);
            row.extend(
                [
                    quantity.error().unwrap_or(f64::NAN),
                    runs.speed(),
                    runs.wall_secs(),
                    runs.unsolved(),
                ]
                .map(|x| x.to_string()),
            );
            rows.push(row);
        }
    }
    let columns = "experiment way quantity system source provenance published published_low published_high measured \
                   measured_low measured_high samples verdict error simulated_secs_per_sec wall_secs \
                   share_of_unsolved_steps";
    ReportTable::new("quantities", columns, rows)
}

pub(super) fn markdown(all: &[ExperimentRuns], effort: Effort, machine: &str, secs: f64) -> String {
    let mut text = "# Published experiments\n\n".to_owned();
    if effort == Effort::Quick {
        text.push_str("Quick pass: smaller systems, and fewer of them, than in the full one.\n\n");
    }
    // Writing to a string cannot fail.
    let _ = write!(
        text,
        "{machine}; {secs:.0} s, runs that were there before not counted.\n\nIntervals hold the true value in 95 % \
         of samples. A quantity agrees where its whole interval lies in the published band and differs where all of \
         it lies outside; the rest is not decided. Where a number comes from: *read* in the source or a review that \
         quotes it; *recalled* and not looked up, so that it gets no verdict; *derived* from the scene, by approximations that are \
         named; *exact*.\n\n![errors](errors.png)\n",
    );
    text.push_str(&summary(all));
    let mut last = "";
    for runs in all {
        let experiment = runs.experiment;
        if experiment.name != last {
            let _ = write!(text, "\n## {}\n\n{}\n", experiment.title, experiment.about);
            last = experiment.name;
        }
        text.push_str(&of_variant(runs));
    }
    text
}

fn summary(all: &[ExperimentRuns]) -> String {
    let verdicts: Vec<Agreement> =
        all.iter().flat_map(ExperimentRuns::judged).map(|(_, verdict)| verdict).collect();
    let count = |verdict| verdicts.iter().filter(|&&one| one == verdict).count();
    format!(
        "\nOf {} quantities {} agree, {} differ and {} are not decided; {} were recalled and have no verdict.\n",
        verdicts.len(),
        count(Agreement::Agrees),
        count(Agreement::Differs),
        count(Agreement::NotDecided),
        count(Agreement::NoVerdict)
    )
}

fn of_variant(runs: &ExperimentRuns) -> String {
    let mut text = format!(
        "\n**{}**: {} runs in {:.1} s of one core, {:.2} simulated seconds per second.",
        runs.words(),
        runs.cases.len(),
        runs.wall_secs(),
        runs.speed()
    );
    if !runs.has_sweeps_alone() {
        let _ = match runs.unsolved() {
            0.0 => write!(text, " Every step was solved as asked."),
            share => write!(text, " {:.1} % of the steps were not solved as asked.", 100.0 * share),
        };
    }
    if let Some(why) = runs.spoilt() {
        let _ = write!(text, " Nothing is decided: {why}.");
    }
    text.push_str(
        "\n\n| quantity | system | published | band | from | measured | 95 % interval | verdict |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    for (quantity, verdict) in runs.judged() {
        let PublishedQuantity { name, system, published, band, kind, source, measured } = &quantity;
        let _ = writeln!(
            text,
            "| {name} | {system} | {} | {} | {}: {source} | {} | {} | **{}** |",
            short(*published),
            ends(band[0], band[1]),
            kind.words(),
            short(measured.mean),
            ends(measured.low, measured.high),
            verdict.words()
        );
    }
    text
}

/// Draws two charts: the error relative to published values, and the speed in simulated seconds per second. Each
/// experiment has one row, and each solver variant one point in the row.
pub(super) fn sheet(all: &[ExperimentRuns], machine: &str) -> Sheet {
    let variants = distinct(all.iter().filter_map(|runs| runs.variant));
    let names = distinct(all.iter().map(|runs| runs.experiment.name));
    let count = names.len() as f64;
    let numbers = |number: fn(&ExperimentRuns) -> f64| {
        let numbers = all.iter().map(number).filter(|number| number.is_finite());
        numbers.fold([f64::INFINITY, 0.0], |[least, most], x| [least.min(x), most.max(x)])
    };
    let [slowest, fastest] = numbers(ExperimentRuns::speed);
    let mut charts = Vec::new();
    for (label, ends, number) in [
        (
            "mean relative error",
            [0.5 * LEAST_ERROR, MOST_ERROR],
            error as fn(&ExperimentRuns) -> f64,
        ),
        (
            "simulated seconds per second",
            [0.5 * slowest.min(1e3), 2.0 * fastest.max(1e-3)],
            ExperimentRuns::speed,
        ),
    ] {
        let mut y = Axis::linear("", -count, 1.0);
        y.ticks =
            (0..).zip(&names).map(|(row, name)| (-f64::from(row), (*name).to_owned())).collect();
        let mut chart = Chart::new("", Axis::log(label, ends[0], ends[1]), y);
        for runs in all {
            let row = names.iter().position(|name| *name == runs.experiment.name).unwrap_or(0);
            let (name, colour, look) = match runs.variant {
                None => ("methods of its own".to_owned(), INK, Look::Rings(8)),
                Some(variant) => look_of(&variant, &variants),
            };
            let x = number(runs);
            let place = points(x.is_finite().then_some((x, -(row as f64))));
            chart.layers.push(Layer::curve(name, place, colour, look));
        }
        charts.push(chart);
    }
    let caption = vec![
        "Error: mean deviation of an experiment's quantities from the published values, those of 0 left out, drawn \
         between 1e-3 and 2. Runs were timed while the other cores ran others."
            .to_owned(),
        machine.to_owned(),
    ];
    Sheet { size: (1300, 120 + 46 * names.len() as u32), charts, caption }
}

/// Returns the relative error of one solver variant in an experiment: the mean over the experiment's quantities,
/// limited to the range of the chart's axis. The error is NaN if a quantity has no measured value, because the mean of
/// the other quantities would be too favourable.
fn error(runs: &ExperimentRuns) -> f64 {
    let errors = runs.judged().into_iter().filter_map(|(quantity, _)| quantity.error());
    mean(&errors.collect::<Vec<_>>()).mean.clamp(LEAST_ERROR, MOST_ERROR)
}

/// Returns the name, the colour and the style of a solver variant's points in the charts. There is one colour per
/// method and time step. Variants with a number of sweeps are drawn as filled discs, variants with a tolerance as
/// rings; each further effort (number of sweeps or tolerance) of a method has a larger symbol.
fn look_of(variant: &StepVariant, variants: &[StepVariant]) -> (String, Rgb, Look) {
    let kinds = distinct(variants.iter().map(|one| (one.method, one.time_step_secs)));
    let kind = (variant.method, variant.time_step_secs);
    let index = kinds.iter().position(|one| *one == kind).unwrap_or_default();
    let budgets = variants.iter().filter(|one| (one.method, one.time_step_secs) == kind);
    let number = budgets.take_while(|one| *one != variant).count();
    let radius = 6 + 2 * number as u32;
    let look = match variant.budget {
        SolveBudget::Sweeps(_) => Look::Dots(radius),
        SolveBudget::Residual(_) | SolveBudget::Default => Look::Rings(radius),
    };
    let name = format!(
        "{}, Δt {:e} s\n{}",
        variant.method,
        variant.time_step_secs,
        variant.budget.words()
    );
    (name, PALETTE[1 + index % (PALETTE.len() - 1)], look)
}
