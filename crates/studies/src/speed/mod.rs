//! Measures the speed and the accuracy of solver methods, in single steps of small and large piles and in whole
//! simulations, and draws charts of them. The charts compare all solver methods of the program.
//!
//! The folder of a chart contains pictures (PNG and SVG), tables (CSV), `chart.md`, initial states, and the folder
//! `measured/`. In `measured/`, each build of the program and each processor has its own journals of measurements. If a
//! command is stopped, the same command resumes its work, and times of different builds are never mixed.

mod collection;
mod performance;
mod several;
mod simulations;
mod solves;
mod steps;
mod variants;

use std::path::PathBuf;
use std::time::Instant;

use crate::chart::Sheet;
use crate::error::Result;
use crate::harness::{Bench, Effort, ReportTable};
use crate::output::{note_line, print_text};

/// A part of the charts that compare the speed and the accuracy of solver methods: one kind of measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum ChartPart {
    /// Error against the time of a step
    Step,
    /// Error of the slump against simulated seconds per second
    Simulation,
    /// Error against the time of a step, for 138 to 10,000 grains
    Size,
    /// Number of solutions of a step, and their distances
    Solutions,
}

/// Options of the charts that compare the speed and the accuracy of solver methods.
#[derive(clap::Args, Clone, Debug)]
pub struct ChartOptions {
    /// Folder for pictures, tables and measurements; the same command continues where it stopped
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// A coarser version that takes a few minutes
    #[arg(long)]
    pub quick: bool,
    /// Also measure steps of 138 to 10,000 grains, and search for several solutions of a step
    #[arg(long)]
    pub large: bool,
    /// Chart only these parts
    #[arg(long, value_name = "PART", value_delimiter = ',')]
    pub only: Vec<ChartPart>,
}

struct ChartSection {
    name: String,
    sheet: Sheet,
    words: String,
    /// Tables of this section of the report, which are written as CSV files. The first table is also in the text of the
    /// report.
    tables: Vec<ReportTable>,
}

/// Measures the speed and the accuracy of solver methods, and writes charts and a report to a folder. `version` is the
/// version of the program that the charts name.
///
/// # Errors
/// If the folder cannot be written, or a simulation fails.
pub fn chart_speed(options: &ChartOptions, version: &str) -> Result<()> {
    let bench = Bench::new(&options.out, Effort::new(options.quick), version)?;
    let is_wanted = |part| match part {
        _ if !options.only.is_empty() => options.only.contains(&part),
        ChartPart::Size | ChartPart::Solutions => options.large,
        ChartPart::Step | ChartPart::Simulation => true,
    };
    let mut report = format!("# Speed against accuracy\n\n{}\n", bench.machine.words());
    type Make = fn(&Bench) -> Result<Vec<ChartSection>>;
    let makers: [(ChartPart, &str, Make); 4] = [
        (ChartPart::Step, "Single steps", steps::make),
        (ChartPart::Simulation, "Whole simulations", simulations::make),
        (ChartPart::Size, "Steps by size", steps::make_sizes),
        (ChartPart::Solutions, "Solutions of a step", several::make),
    ];
    for (_, title, make) in makers.into_iter().filter(|(part, ..)| is_wanted(*part)) {
        let begun = Instant::now();
        report.push_str(&format!("\n## {title}\n"));
        for ChartSection { name, sheet, words, tables } in make(&bench)? {
            bench.write((&name, &sheet), &tables, &bench.machine.command)?;
            let summary = tables.first().map_or_else(String::new, ReportTable::to_markdown);
            report.push_str(&format!("\n![{name}]({name}.png)\n\n{words}\n\n{summary}\n"));
        }
        note_line(format_args!("{title}: {:.0} s", begun.elapsed().as_secs_f64()));
    }
    print_text(format!("{report}\n"));
    bench.finish("chart.md", &report)
}

fn listed<T>(values: impl IntoIterator<Item = T>, word: impl Fn(T) -> String) -> String {
    values.into_iter().map(word).collect::<Vec<_>>().join(", ")
}
