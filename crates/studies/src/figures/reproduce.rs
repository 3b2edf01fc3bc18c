//! Writes the figures, the tables and the report that compare simulations with Abramian & Staron (2020).

use std::fmt::Write as _;
use std::path::Path;
use std::time::Instant;

use super::studies::FinishedStudy;
use super::{FIGURES, Figure, FigureInfo, StudyRunner};
use crate::error::{Error, Result};
use crate::harness::{Bench, Effort};
use crate::output::{note_line, print_line, print_text};
use crate::solver::worst;

/// Names of those figures that are pictures of grains. They are always drawn together.
const SNAPSHOTS: [&str; 3] = ["fig3", "fig4", "fig7"];
const ALL: &str = "all";

/// Returns the names of figures that [`reproduce`] accepts.
pub fn figure_names() -> Vec<&'static str> {
    let charts = FIGURES.iter().map(|figure| figure.name);
    [ALL].into_iter().chain(SNAPSHOTS).chain(charts).collect()
}

/// Writes the figures with these names to `folder`, each as PNG, SVG and CSV, and the file `report.md`. All runs are
/// stored in a folder below `folder`, so if the reproduction is stopped, a call with the same arguments resumes it. If
/// `quick` is true, the figures have fewer runs. The function `snapshots` draws the pictures of grains (Figs. 3, 4 and
/// 7) into a folder. `version` is the version of the program that the report names.
///
/// # Errors
/// If a name is unknown, the folder cannot be written, or a study fails.
pub fn reproduce(
    names: &[String],
    folder: &Path,
    quick: bool,
    version: &str,
    snapshots: impl FnOnce(&Path) -> Result<()>,
) -> Result<()> {
    let started = Instant::now();
    let known = figure_names();
    if let Some(unknown) = names.iter().find(|name| !known.contains(&name.as_str())) {
        return Err(Error::value("figure", unknown, format!("one of {}", known.join(", "))));
    }
    let wanted = |name: &str| names.iter().any(|asked| asked == name || asked == ALL);
    let effort = Effort::new(quick);
    let bench = Bench::new(folder, effort, version)?;
    let mut studies = StudyRunner::new(folder.join("studies"), effort);
    let mut report = opening(effort);
    for info in FIGURES.iter().filter(|figure| wanted(figure.name)) {
        let begun = Instant::now();
        for study in info.studies {
            studies.run(study)?;
        }
        let mut figure = (info.make)(&studies)?;
        studies.qualify(info.studies, &mut figure.claims);
        figure.sheet.caption.extend(studies.note(info.studies));
        let command = format!("slump reproduce {} --out figures{}", info.name, effort.option());
        bench.write((figure.name, &figure.sheet), &figure.table, &command)?;
        note_line(format_args!("{}: {:.0} s", info.name, begun.elapsed().as_secs_f64()));
        report.push_str(&section(info, &figure));
    }
    if SNAPSHOTS.iter().any(|name| wanted(name)) {
        snapshots(folder)?;
        let pictures = SNAPSHOTS.map(|name| format!("\n![{name}]({name}.png)\n"));
        report.push_str(&format!("\n## Snapshots\n{}", pictures.concat()));
    }
    report.push_str(&closing(&studies));
    let _ = writeln!(
        report,
        "\nMade in {:.0} s, studies that were there before not counted: {}.",
        started.elapsed().as_secs_f64(),
        bench.machine.words()
    );
    bench.finish("report.md", &report)
}

fn opening(effort: Effort) -> String {
    let mut text = "# What the paper says, and what was measured\n\n".to_owned();
    if effort == Effort::Quick {
        text.push_str("Quick pass: coarser, with fewer initial states than the full one.\n\n");
    }
    text.push_str(
            "p-values are one-sided unless they say otherwise; a claim holds below 0.05, and does not \
             hold where its contrary is below 0.05. Intervals hold the true value in 95 % of samples. *By chance* says how often \
             the same test says that a claim holds where Δt has no effect, by shuffling Δt among the runs of each initial \
             state; *hangs on* names the choices that were free.\n\n\
             Alarms that runs raised are counted with each claim. A claim on runs that lost grains, or had no \
             finite end, is not decided.\n",
        );
    text
}

/// Returns the section of the report about a figure. The tested statements, their verdicts, and the table of the
/// section are also printed on the terminal.
fn section(info: &FigureInfo, figure: &Figure) -> String {
    let mut text = format!("\n## {0}\n\n![{0}]({0}.png)\n\n", figure.name);
    // Writing to a string cannot fail.
    for claim in &figure.claims {
        let _ = writeln!(text, "* {}.\n  Measured: {}.", claim.said, claim.measured);
        for (what, words) in [("By chance", &claim.by_chance), ("Hangs on", &claim.hangs_on)] {
            if !words.is_empty() {
                let _ = writeln!(text, "  {what}: {words}.");
            }
        }
        let _ = writeln!(text, "  **{}**", claim.verdict.words());
        print_line(format_args!("{}: {} [{}]", info.name, claim.said, claim.verdict.words()));
        print_line(format_args!("    {}", claim.measured));
    }
    if let Some(table) = &figure.table {
        let _ = write!(text, "\n{}", table.to_markdown());
        print_text(table.to_markdown());
    }
    if figure.claims.is_empty() {
        text.push_str("No claim is tested on this figure.\n");
    }
    text
}

fn closing(studies: &StudyRunner) -> String {
    let mut text = String::from(
        "\n## Studies\n\n| study | runs | core seconds | steps not solved as asked | largest residual \
             | not finite |\n|---|---|---|---|---|---|\n",
    );
    for (name, FinishedStudy { table, .. }) in &studies.finished {
        let results = || table.rows.iter().map(|(.., result)| result);
        let steps: u64 = results().map(|result| result.tally.steps).sum();
        let unsolved: u64 = results().map(|result| result.tally.unconverged_steps).sum();
        let residual = results().map(|result| result.tally.largest_residual).fold(0.0, worst);
        let _ = writeln!(
            text,
            "| {name} | {} | {:.0} | {:.2} % | {residual:.1e} | {} |",
            table.rows.len(),
            table.wall_secs.iter().sum::<f64>(),
            100.0 * unsolved as f64 / steps.max(1) as f64,
            table.not_finite()
        );
    }
    text
}
