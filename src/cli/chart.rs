//! `slump chart`: speed against accuracy.

use std::path::PathBuf;

use crate::error::Result;
use crate::study::{ChartOptions, ChartPart, chart_speed};

/// Arguments of `slump chart`.
#[derive(clap::Args)]
pub(super) struct ChartCommand {
    /// Folder for pictures, tables and measurements; the same command goes on where it stopped
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Coarser, in a few minutes
    #[arg(long)]
    quick: bool,
    /// Also race on steps of 500, 2,000 and 10,000 grains, and simulate 2,000
    #[arg(long)]
    large: bool,
    /// Chart these alone
    #[arg(long, value_name = "PART", value_delimiter = ',')]
    only: Vec<ChartPart>,
}

impl ChartCommand {
    /// Does what is asked.
    pub(super) fn run(self) -> Result<()> {
        let Self { out, quick, large, only } = self;
        chart_speed(&ChartOptions { out, quick, large, only })
    }
}
