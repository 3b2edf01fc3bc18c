//! `slump sweep`: a study from its file, on one machine or on many.

use std::path::PathBuf;

use crate::error::{Error, Result};
use crate::output::{note_line, print_line};
use crate::study::{RunsTable, Shard, Study, SweepOptions, merge, sweep};

/// Arguments of `slump sweep`.
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
    command: Option<Action>,
}

#[derive(clap::Subcommand)]
enum Action {
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
    /// Does what is asked.
    pub(super) fn run(self) -> Result<()> {
        match self.command {
            Some(Action::Merge { study, parts, out, quick }) => {
                let study = Study::read(&study, quick)?;
                let out = out.unwrap_or_else(|| parts[0].clone());
                tell(&merge(&study, &parts, &out)?, &out);
                Ok(())
            }
            Some(Action::Count { study, quick }) => {
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
                    Some(table) => tell(&table, &out),
                    None => {
                        print_line(format_args!("a part of {} in {}", study.name, out.display()))
                    }
                }
                Ok(())
            }
        }
    }
}

fn tell(table: &RunsTable, folder: &std::path::Path) {
    let file = folder.join("runs.csv");
    print_line(format_args!(
        "{} runs in {} ({:.0} core seconds)",
        table.rows.len(),
        file.display(),
        table.core_secs
    ));
    if table.not_finite() > 0 {
        note_line(format_args!(
            "{} runs ended early: their state was no longer finite",
            table.not_finite()
        ));
    }
    if let Some(told) = table.alarms() {
        note_line(format_args!("{told}"));
    }
}
