//! Commands of studies: `sweep`, `reproduce`, `chart`, `stability` and `validate`.

use std::path::{Path, PathBuf};

use clap::builder::PossibleValuesParser;

use crate::config::parser_of;
use crate::error::{Error, Result};
use crate::headless::draw_snapshots;
use crate::output::{
    Progress, check_file, check_writable, note_line, print_line, print_text, write_file,
};
use crate::solver::Method;
use crate::study::chart::{png, svg};
use crate::study::stability::{
    CHALLENGES, Challenge, StabilityTable, count_of_maps, maps, picture,
};
use crate::study::{
    ChartOptions, ChartPart, RunsTable, Shard, Study, SweepOptions, ValidateOptions, chart_speed,
    experiment_names, figure_names, merge, reproduce, sweep, validate,
};

/// `slump sweep`.
#[derive(clap::Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(super) struct SweepCommand {
    /// The study file (NAME.toml)
    #[arg(value_name = "STUDY", required = true)]
    study: Option<PathBuf>,
    /// Folder for the results; the same command goes on where it stopped
    #[arg(long, value_name = "DIR", required = true)]
    out: Option<PathBuf>,
    /// Run part K of N alone; `slump sweep merge` joins the parts
    #[arg(long, value_name = "K/N")]
    shard: Option<String>,
    /// Run the study's quick pass, which is coarser
    #[arg(long)]
    quick: bool,
    /// Throw away what the folder holds of another study, or what cannot be read
    #[arg(long)]
    redo: bool,
    #[command(subcommand)]
    command: Option<SweepAction>,
}

#[derive(clap::Subcommand)]
enum SweepAction {
    /// Join the parts of a study into runs.csv
    Merge {
        /// The study file (NAME.toml)
        study: PathBuf,
        /// Folders that hold parts
        #[arg(required = true, value_name = "DIR")]
        parts: Vec<PathBuf>,
        /// Folder for runs.csv; the first part's where nothing is said
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// The parts are of the study's quick pass
        #[arg(long)]
        quick: bool,
    },
    /// Print how many runs a study has
    Count {
        /// The study file (NAME.toml)
        study: PathBuf,
        /// Count the runs of the study's quick pass
        #[arg(long)]
        quick: bool,
    },
}

impl SweepCommand {
    pub(super) fn run(self) -> Result<()> {
        match self.command {
            Some(SweepAction::Merge { study, parts, out, quick }) => {
                let study = Study::read(&study, quick)?;
                let out = out.unwrap_or_else(|| parts[0].clone());
                report_runs(&merge(&study, &parts, &out)?, &out);
                Ok(())
            }
            Some(SweepAction::Count { study, quick }) => {
                print_line(Study::read(&study, quick)?.runs.len());
                Ok(())
            }
            None => {
                let missing = |field| Error::value(field, "missing", "given");
                let study = Study::read(&self.study.ok_or_else(|| missing("study"))?, self.quick)?;
                let out = self.out.ok_or_else(|| missing("out"))?;
                let shard = self.shard.map(|text| text.parse::<Shard>()).transpose()?;
                let options = SweepOptions { shard, redo: self.redo, states: None };
                match sweep(&study, &out, &options)? {
                    Some(table) => report_runs(&table, &out),
                    None => {
                        print_line(format_args!("a part of {} in {}", study.name, out.display()))
                    }
                }
                Ok(())
            }
        }
    }
}

fn report_runs(table: &RunsTable, folder: &Path) {
    let (runs, file, secs) = (table.rows.len(), folder.join("runs.csv"), table.core_secs);
    print_line(format_args!("{runs} runs in {} ({secs:.0} core seconds)", file.display()));
    let ended = table.not_finite();
    if ended > 0 {
        note_line(format_args!("{ended} runs ended early: their state was no longer finite"));
    }
    if let Some(told) = table.alarms() {
        note_line(format_args!("{told}"));
    }
}

/// `slump reproduce`.
#[derive(clap::Args)]
pub(super) struct ReproduceCommand {
    /// Figures, or all
    #[arg(required = true, value_name = "FIGURE", value_parser = PossibleValuesParser::new(figure_names()))]
    figures: Vec<String>,
    /// Folder for figures, tables and report; the same command goes on where it stopped
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Coarser, in a few minutes
    #[arg(long)]
    quick: bool,
}

impl ReproduceCommand {
    pub(super) fn run(&self) -> Result<()> {
        reproduce(&self.figures, &self.out, self.quick, draw_snapshots)
    }
}

/// `slump chart`.
#[derive(clap::Args)]
pub(super) struct ChartCommand {
    /// Folder for pictures, tables and measurements; the same command goes on where it stopped
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Coarser, in a few minutes
    #[arg(long)]
    quick: bool,
    /// Also race on steps of 500, 2,000 and 10,000 grains
    #[arg(long)]
    large: bool,
    /// Chart these alone
    #[arg(long, value_name = "PART", value_delimiter = ',')]
    only: Vec<ChartPart>,
}

impl ChartCommand {
    pub(super) fn run(self) -> Result<()> {
        let Self { out, quick, large, only } = self;
        chart_speed(&ChartOptions { out, quick, large, only })
    }
}

/// `slump stability`.
#[derive(clap::Args)]
pub(super) struct StabilityCommand {
    /// Challenges; all where none is given
    #[arg(value_name = "SCENE")]
    scenes: Vec<String>,
    /// Folder for the table and its picture, and, unless challenges are given, the stability maps
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// File for the table alone, as CSV
    #[arg(long, value_name = "FILE")]
    table: Option<PathBuf>,
    /// Leave the longest runs out: under a minute, and what the tests compare with
    #[arg(long)]
    quick: bool,
}

impl StabilityCommand {
    pub(super) fn run(self) -> Result<()> {
        let named: Result<Vec<_>> = self.scenes.iter().map(|name| Challenge::named(name)).collect();
        let challenges = match named? {
            named if named.is_empty() => CHALLENGES.iter().collect(),
            named => named,
        };
        if let Some(folder) = &self.out {
            check_writable("out", folder)?;
        }
        self.table.as_deref().map(|table| check_file("table", table)).transpose()?;
        let count = StabilityTable::count(&challenges, self.quick) as u64;
        let progress = Progress::new("stability", count);
        let table = StabilityTable::run(&challenges, self.quick, || {
            progress.advance(1);
        });
        progress.finish();
        let table = table?;
        print_text(&table);
        if let Some(folder) = &self.out {
            write_file(&folder.join("table.csv"), &table.to_csv()?)?;
            let quick = if self.quick { " --quick" } else { "" };
            let scenes: String = self.scenes.iter().map(|name| format!(" {name}")).collect();
            let command = format!("slump stability{quick}{scenes} --out stability");
            let mut sheets = vec![("table".to_owned(), picture(&table))];
            if self.scenes.is_empty() {
                let progress = Progress::new("maps", count_of_maps() as u64);
                let maps = maps(self.quick, || progress.advance(1));
                progress.finish();
                sheets.extend(maps?);
            }
            for (name, sheet) in &sheets {
                write_file(&folder.join(format!("{name}.png")), &png(sheet, &command)?)?;
                write_file(&folder.join(format!("{name}.svg")), svg(sheet)?.as_bytes())?;
                if name != "table" {
                    write_file(&folder.join(format!("{name}.csv")), &sheet.to_csv()?)?;
                }
            }
            print_line(folder.display());
        }
        if let Some(path) = &self.table {
            write_file(path, &table.to_csv()?)?;
            print_line(path.display());
        }
        Ok(())
    }
}

/// `slump validate`.
#[derive(clap::Args)]
pub(super) struct ValidateCommand {
    /// Experiments; all where none is given
    #[arg(value_name = "EXPERIMENT", value_parser = PossibleValuesParser::new(experiment_names()))]
    experiments: Vec<String>,
    /// Folder for report, tables and figure; the same command goes on where it stopped
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Smaller systems and fewer of them, in a few minutes
    #[arg(long)]
    quick: bool,
    /// Methods, each with every time step and effort [default: nsgs]
    #[arg(long, value_name = "NAME", value_delimiter = ',', value_parser = parser_of::<Method>())]
    methods: Vec<Method>,
    /// Time steps, seconds [default: 1e-3, and 3e-4 unless quick]
    #[arg(long, value_name = "SECONDS", value_delimiter = ',', allow_negative_numbers = true)]
    time_steps: Vec<f64>,
    /// Efforts: this many sweeps a step, whatever they come to [default: 20 and 100, if no tolerance is given either]
    #[arg(long, value_name = "N", value_delimiter = ',')]
    sweeps: Vec<u32>,
    /// Efforts: residuals that a step is solved to, within 1,000 sweeps
    #[arg(long, value_name = "X", value_delimiter = ',', allow_negative_numbers = true)]
    tolerances: Vec<f64>,
}

impl ValidateCommand {
    pub(super) fn run(self) -> Result<()> {
        let Self { experiments, out, quick, methods, time_steps, sweeps, tolerances } = self;
        let time_steps_secs = time_steps;
        validate(&ValidateOptions {
            experiments,
            out,
            quick,
            methods,
            time_steps_secs,
            sweeps,
            tolerances,
        })
    }
}
