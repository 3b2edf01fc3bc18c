//! What was found in words, as a table, and as JSON.

use std::fmt::Write as _;

use serde_json::json;

use super::quantity::{Expected, Quantity, Verdict};
use super::runs::Ran;
use crate::error::{Error, Result};
use crate::report::ReportTable;

/// A number as it is written.
fn short(number: f64) -> String {
    if !number.is_finite() {
        return "none".into();
    }
    let digits = if number.abs() < 10.0 { 3 } else { 1 };
    format!("{number:.digits$}").replace('-', "−")
}

/// Two ends of a band or an interval.
fn ends(low: f64, high: f64) -> String {
    match (low.is_finite(), high.is_finite()) {
        (false, false) => "none".into(),
        (false, true) => format!("at most {}", short(high)),
        (true, false) => format!("at least {}", short(low)),
        (true, true) => format!("{} … {}", short(low), short(high)),
    }
}

/// Every quantity of every experiment in every way.
pub(super) fn table(all: &[Ran]) -> ReportTable {
    let mut rows = Vec::new();
    for ran in all {
        for (quantity, verdict) in ran.judged() {
            let Quantity { name, system, expected, measured } = &quantity;
            let Expected { value, low, high, provenance, source } = expected;
            let numbers = [*value, *low, *high, measured.mean, measured.low, measured.high];
            let mut row = vec![ran.experiment.name.to_owned(), ran.words(), name.clone()];
            row.extend([system.clone(), (*source).to_owned(), provenance.words().to_owned()]);
            row.extend(numbers.map(|number| number.to_string()));
            row.extend([measured.count.to_string(), verdict.words().to_owned()]);
            row.extend(
                [quantity.error(), ran.speed(), ran.wall_secs(), ran.unsolved()]
                    .map(|x| x.to_string()),
            );
            rows.push(row);
        }
    }
    let columns = vec![
        "experiment",
        "way",
        "quantity",
        "system",
        "source",
        "provenance",
        "published",
        "published_low",
        "published_high",
        "measured",
        "measured_low",
        "measured_high",
        "samples",
        "verdict",
        "error",
        "simulated_secs_per_sec",
        "wall_secs",
        "share_of_unsolved_steps",
    ];
    ReportTable { name: "quantities", columns, rows }
}

/// The same as JSON: numbers as numbers, and those that do not exist as null.
///
/// # Errors
/// Where it cannot be said in JSON.
pub(super) fn json(all: &[Ran]) -> Result<String> {
    let mut rows = Vec::new();
    for ran in all {
        for (quantity, verdict) in ran.judged() {
            let Quantity { name, system, expected, measured } = &quantity;
            rows.push(json!({
                "experiment": ran.experiment.name,
                "way": ran.words(),
                "quantity": name,
                "system": system,
                "published": expected,
                "measured": { "mean": measured.mean, "low": measured.low, "high": measured.high },
                "samples": measured.count,
                "verdict": verdict,
                "error": quantity.error(),
                "simulated_secs_per_sec": ran.speed(),
                "wall_secs": ran.wall_secs(),
                "share_of_unsolved_steps": ran.unsolved(),
            }));
        }
    }
    let refuse = |error| Error::file("quantities.json", error);
    serde_json::to_string_pretty(&rows).map(|text| text + "\n").map_err(refuse)
}

/// `report.md`.
pub(super) fn told(all: &[Ran], quick: bool, machine: &str, secs: f64) -> String {
    let mut text = "# Published experiments\n\n".to_owned();
    if quick {
        text.push_str("Quick pass: smaller systems, and fewer of them, than in the full one.\n\n");
    }
    // Writing to a string cannot fail.
    let _ = write!(
        text,
        "{machine}; {secs:.0} s, runs that were there before not counted.\n\nIntervals hold the true value in 95 % \
         of samples. A quantity agrees where its whole interval lies in the published band and differs where all of \
         it lies outside; the rest is not decided. Where a number comes from: *read* in the source or a review that \
         quotes it; *memory*: recalled and not looked up yet, so that the band is generous and tests a trend alone; \
         *derived* from what the scene is, by approximations that are named; *exact*.\n\n![errors](errors.png)\n",
    );
    text.push_str(&summary(all));
    let mut last = "";
    for ran in all {
        let experiment = ran.experiment;
        if experiment.name != last {
            let _ = write!(text, "\n## {}\n\n{}\n", experiment.title, experiment.about);
            last = experiment.name;
        }
        text.push_str(&of_way(ran));
    }
    text
}

/// How many quantities came out each way.
fn summary(all: &[Ran]) -> String {
    let verdicts: Vec<Verdict> =
        all.iter().flat_map(Ran::judged).map(|(_, verdict)| verdict).collect();
    let count = |verdict| verdicts.iter().filter(|&&one| one == verdict).count();
    format!(
        "\nOf {} quantities {} agree, {} differ and {} are not decided.\n",
        verdicts.len(),
        count(Verdict::Agrees),
        count(Verdict::Differs),
        count(Verdict::NotDecided)
    )
}

/// The quantities of an experiment in one way.
fn of_way(ran: &Ran) -> String {
    let mut text = format!(
        "\n**{}**: {} runs in {:.1} s of one core, {:.2} simulated seconds per second.",
        ran.words(),
        ran.found.len(),
        ran.wall_secs(),
        ran.speed()
    );
    if ran.unsolved() > 0.0 && !ran.has_sweeps_alone() {
        let _ =
            write!(text, " {:.1} % of the steps were not solved as asked.", 100.0 * ran.unsolved());
    }
    if let Some(why) = ran.spoilt() {
        let _ = write!(text, " Nothing is decided: {why}.");
    }
    text.push_str(
        "\n\n| quantity | system | published | band | from | measured | 95 % interval | verdict |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    for (quantity, verdict) in ran.judged() {
        let Quantity { name, system, expected, measured } = &quantity;
        let _ = writeln!(
            text,
            "| {name} | {system} | {} | {} | {}: {} | {} | {} | **{}** |",
            short(expected.value),
            ends(expected.low, expected.high),
            expected.provenance.words(),
            expected.source,
            short(measured.mean),
            ends(measured.low, measured.high),
            verdict.words()
        );
    }
    text
}
