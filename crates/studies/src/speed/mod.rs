//! Speed charted against accuracy: of single steps, small and large, and of whole simulations. Every method of
//! the registry is on every chart.
//!
//! The folder of a chart holds pictures (PNG and SVG), tables (CSV), `chart.md`, initial states, and
//! `measured/`: journals of what was measured, by program and processor, so that the same command
//! goes on where it was stopped and never mixes times of different programs.

mod collection;
mod performance;
mod several;
mod simulations;
mod solves;
mod steps;
mod variants;

use std::path::PathBuf;
use std::time::Instant;

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::chart::Sheet;
use crate::error::Result;
use crate::harness::{Effort, Machine, ReportTable, Runner, write_sheet};
use crate::output::{check_writable, note_line, print_line, print_text, remove_drafts, write_file};

/// Something to chart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum ChartPart {
    /// Error against the time of a step
    Step,
    /// Error of the slump against simulated seconds per second
    Simulation,
    /// Error against the time of a step, of 138 to 10,000 grains
    Size,
    /// How many solutions steps have, and how far apart they are
    Solutions,
}

/// What to chart, and how.
#[derive(clap::Args, Clone, Debug)]
pub struct ChartOptions {
    /// Folder for pictures, tables and measurements; the same command goes on where it stopped
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Coarser, in a few minutes
    #[arg(long)]
    pub quick: bool,
    /// Also race on steps of 138 to 10,000 grains, and look for the solutions that steps have
    #[arg(long)]
    pub large: bool,
    /// Chart these alone
    #[arg(long, value_name = "PART", value_delimiter = ',')]
    pub only: Vec<ChartPart>,
}

struct ChartSection {
    name: String,
    sheet: Sheet,
    words: String,
    summary: ReportTable,
    /// Tables that the report does not show.
    others: Vec<ReportTable>,
}

struct Bench<'a> {
    options: &'a ChartOptions,
    machine: Machine,
}

impl Bench<'_> {
    fn effort(&self) -> Effort {
        Effort::new(self.options.quick)
    }

    fn states_folder(&self) -> PathBuf {
        self.options.out.join("states")
    }

    fn runner<T: Clone + Send + Sync + Serialize + DeserializeOwned>(
        &self,
        name: &str,
    ) -> Result<Runner<T>> {
        self.machine.runner(&self.options.out, self.effort(), name)
    }

    /// Lines below a chart: what it shows, then where it was measured.
    fn caption(&self, lines: &[&str]) -> Vec<String> {
        let mut caption: Vec<String> = lines.iter().map(|&line| line.to_owned()).collect();
        caption.push(format!("{}{}", self.effort().note(), self.machine.words()));
        caption
    }

    /// Writes the files of a section, and gives its part of the report.
    fn write(&self, section: &ChartSection) -> Result<String> {
        let ChartSection { name, sheet, words, summary, others } = section;
        let folder = &self.options.out;
        write_sheet(folder, name, sheet, &self.machine.command)?;
        for table in others.iter().chain([summary]) {
            write_file(&folder.join(format!("{}.csv", table.name)), &table.to_csv()?)?;
        }
        Ok(format!("\n![{name}]({name}.png)\n\n{words}\n\n{}\n", summary.to_markdown()))
    }
}

/// Measures and draws into a folder. The charts say that `version` of the program made them.
///
/// # Errors
/// Where the folder cannot be written, or a simulation fails.
pub fn chart_speed(options: &ChartOptions, version: &str) -> Result<()> {
    check_writable("out", &options.out)?;
    let bench = Bench { options, machine: Machine::this(version)? };
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
        for section in make(&bench)? {
            report.push_str(&bench.write(&section)?);
        }
        note_line(format_args!("{title}: {:.0} s", begun.elapsed().as_secs_f64()));
    }
    let path = options.out.join("chart.md");
    write_file(&path, report.as_bytes())?;
    remove_drafts(&options.out)?;
    print_text(&report);
    print_line(format_args!("\n{}", path.display()));
    Ok(())
}

fn listed<T>(values: impl IntoIterator<Item = T>, word: impl Fn(T) -> String) -> String {
    values.into_iter().map(word).collect::<Vec<_>>().join(", ")
}
