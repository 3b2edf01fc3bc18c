//! `slump validate`: published experiments.

use std::path::PathBuf;

use clap::builder::PossibleValuesParser;

use crate::config::parser_of;
use crate::error::Result;
use crate::solver::Method;
use crate::study::{ValidateOptions, experiment_names, validate};

/// Arguments of `slump validate`.
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
    /// Does what is asked.
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
