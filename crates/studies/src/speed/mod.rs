//! Speed charted against accuracy: of single steps, by their size as well, of whole simulations, and what a scene
//! saves by computing no more than it needs. Every method of the registry is on every chart.
//!
//! The folder of a chart holds pictures (PNG and SVG), tables (CSV), `chart.md`, initial states, and
//! `measured/`: journals of what was measured, by program and processor, so that the same command
//! goes on where it was stopped and never mixes times of different programs.

mod bench;
mod entrants;
mod look;
mod models;
mod peers;
mod race;
mod rest;
mod runs;
mod simulations;
mod sizes;
mod steps;

use std::path::{Path, PathBuf};
use std::time::Instant;

use self::bench::{Bench, Part};
use super::chart::{png, svg};
use super::machine::Machine;
use crate::error::Result;
use crate::output::{check_writable, note_line, print_line, print_text, write_file};

/// Something to chart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum ChartPart {
    /// Residual against the time of a step, and performance profiles
    Step,
    /// Error of the slump against simulated seconds per second
    Simulation,
    /// What a scene's model costs
    Model,
    /// A step of 2,000 grains at rest against other engines
    Rest,
    /// A step of 500 to 10,000 grains, to residuals and to a certificate
    Size,
}

/// What to chart, and how.
#[derive(Clone, Debug)]
pub struct ChartOptions {
    /// Folder for pictures, tables and measurements.
    pub out: PathBuf,
    /// Coarser, in a few minutes.
    pub quick: bool,
    /// Also steps of up to 10,000 grains, and simulations of 2,000.
    pub large: bool,
    /// The parts; all where there is none.
    pub only: Vec<ChartPart>,
    /// Folder of tables of other engines' runs (`benches/peers`); none are drawn where it is missing.
    pub peers: PathBuf,
}

impl ChartOptions {
    /// The command that charts this, with a folder of one's own.
    fn command(&self) -> String {
        let only = self.only.iter().filter_map(clap::ValueEnum::to_possible_value);
        let only: String = only.map(|part| format!(" --only {}", part.get_name())).collect();
        let switch = |on: bool, word: &str| if on { format!(" --{word}") } else { String::new() };
        let switches = switch(self.quick, "quick") + &switch(self.large, "large");
        format!("slump chart{only}{switches} --out chart")
    }
}

/// Measures and draws into a folder.
///
/// # Errors
/// Where the folder cannot be written, or a simulation fails.
pub fn chart_speed(options: &ChartOptions) -> Result<()> {
    check_writable("out", &options.out)?;
    let bench = Bench {
        folder: options.out.clone(),
        quick: options.quick,
        large: options.large,
        peers: options.peers.clone(),
        machine: Machine::this()?,
    };
    let unasked = |part| match part {
        // Settling 2,000 grains takes longer than the whole quick pass.
        ChartPart::Rest => !options.quick,
        ChartPart::Size => options.large,
        ChartPart::Step | ChartPart::Simulation | ChartPart::Model => true,
    };
    let wanted = |part| {
        if options.only.is_empty() { unasked(part) } else { options.only.contains(&part) }
    };
    let mut report = format!("# Speed against accuracy\n\n{}\n", bench.machine.words());
    type Make = fn(&Bench) -> Result<Vec<Part>>;
    let makers: [(ChartPart, &str, Make); 5] = [
        (ChartPart::Step, "Single steps", steps::make),
        (ChartPart::Simulation, "Whole simulations", simulations::make),
        (ChartPart::Model, "What a scene's model costs", models::make),
        (ChartPart::Rest, "A step at rest, against other engines", rest::make),
        (ChartPart::Size, "Steps by size", sizes::make),
    ];
    for (part, title, make) in makers {
        if !wanted(part) {
            continue;
        }
        let begun = Instant::now();
        report.push_str(&format!("\n## {title}\n"));
        for Part { name, sheet, report: told, tables } in make(&bench)? {
            let path = |ending: &str| options.out.join(format!("{name}.{ending}"));
            write_file(&path("csv"), &sheet.to_csv()?)?;
            write_file(&path("png"), &png(&sheet, &options.command())?)?;
            write_file(&path("svg"), svg(&sheet)?.as_bytes())?;
            for (table, text) in tables {
                write_file(&options.out.join(format!("{table}.csv")), text.as_bytes())?;
            }
            report.push_str(&format!("\n![{name}]({name}.png)\n\n{told}\n"));
        }
        note_line(format_args!("{title}: {:.0} s", begun.elapsed().as_secs_f64()));
    }
    let path = options.out.join("chart.md");
    write_file(&path, report.as_bytes())?;
    print_text(&report);
    print_line(format_args!("\n{}", path.display()));
    Ok(())
}

/// Where the tables of other engines lie in the source tree.
pub fn default_peers_folder() -> &'static Path {
    Path::new("benches/peers/results")
}
