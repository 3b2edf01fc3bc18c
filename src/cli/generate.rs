//! `slump generate`: an initial state.

use std::path::PathBuf;

use crate::error::Result;
use crate::output::{Progress, check_file, print_line, write_file};
use crate::scene::{Rain, Settling, settle, write_discs};

/// Arguments of `slump generate`.
#[derive(clap::Args)]
pub(super) struct GenerateCommand {
    /// Number of grains
    #[arg(long, default_value_t = Rain::default().grains)]
    grains: usize,
    /// Width of the box, in mean diameters
    #[arg(long, default_value_t = Rain::default().box_width_in_diameters, allow_negative_numbers = true)]
    box_width: f64,
    /// Seed of diameters and places
    #[arg(long, default_value_t = Rain::default().seed)]
    seed: u64,
    /// The file to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

impl GenerateCommand {
    /// Does what is asked.
    pub(super) fn run(self) -> Result<()> {
        let Self { grains: count, box_width: width, seed, out } = self;
        check_file("out", &out)?;
        let rain = Rain { grains: count, box_width_in_diameters: width, seed };
        let progress = Progress::new("settling", 100);
        let grains = settle(&rain, |Settling { time_secs, limit_secs, .. }| {
            progress.set((100.0 * time_secs / limit_secs) as u64);
            true
        });
        progress.finish();
        let comment = format!(
            "Discs rained into a box over a rough base and left to come to rest; metres.\n\
             slump generate --grains {count} --box-width {width} --seed {seed}"
        );
        write_file(&out, write_discs(&grains?, &comment).as_bytes())?;
        print_line(out.display());
        Ok(())
    }
}
