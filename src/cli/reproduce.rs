//! `slump reproduce`: the figures of the paper.

use std::path::PathBuf;

use clap::builder::PossibleValuesParser;

use crate::error::Result;
use crate::headless::draw_snapshots;
use crate::study::{figure_names, reproduce};

/// Arguments of `slump reproduce`.
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
    /// Does what is asked.
    pub(super) fn run(&self) -> Result<()> {
        reproduce(&self.figures, &self.out, self.quick, draw_snapshots)
    }
}
