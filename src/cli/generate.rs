//! `slump generate`: an initial state.

use std::path::PathBuf;

use crate::config::{parser_of, write_discs};
use crate::error::Result;
use crate::output::{Progress, check_file, note_line, print_line, write_file};
use crate::scene::{Deposition, NewPile, Settled, Settling, deposit};

/// Arguments of `slump generate`.
#[derive(clap::Args)]
pub(super) struct GenerateCommand {
    /// Number of grains
    #[arg(long, default_value_t = NewPile::default().grains)]
    grains: usize,
    /// Width of the box, in mean diameters
    #[arg(long, default_value_t = NewPile::default().box_width_in_diameters, allow_negative_numbers = true)]
    box_width: f64,
    /// Seed of diameters and places
    #[arg(long, default_value_t = NewPile::default().seed)]
    seed: u64,
    /// How the grains are put in place
    #[arg(long, value_name = "WAY", default_value_t, value_parser = parser_of::<Deposition>())]
    deposition: Deposition,
    /// The file to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

impl GenerateCommand {
    /// Does what is asked.
    pub(super) fn run(self) -> Result<()> {
        let Self { grains: count, box_width: width, seed, deposition, out } = self;
        check_file("out", &out)?;
        let pile = NewPile { grains: count, box_width_in_diameters: width, seed, deposition };
        let progress = Progress::new("settling", 100);
        let settled = deposit(&pile, |Settling { time_secs, limit_secs, .. }| {
            progress.set((100.0 * time_secs / limit_secs) as u64);
            true
        });
        progress.finish();
        let Settled { grains, kinetic_energy, mean_overlap, max_overlap } = settled?;
        let rest = format!(
            "At rest: kinetic energy {kinetic_energy:.1e} m g d a grain, overlap {mean_overlap:.1e} d in the \
             mean and {max_overlap:.1e} d at most."
        );
        let command = format!("slump generate --grains {count} --box-width {width} --seed {seed}");
        let comment = match deposition {
            // The shipped state has these lines alone.
            Deposition::Rain => format!(
                "Discs rained into a box over a rough base and left to come to rest; metres.\n{command}"
            ),
            Deposition::DropAndRoll => format!(
                "Discs dropped into a box over a rough base, each rolled to where two others hold it, and \
                 left to come to rest; metres.\n{rest}\n{command} --deposition drop-and-roll"
            ),
        };
        write_file(&out, write_discs(&grains, &comment).as_bytes())?;
        note_line(&rest);
        print_line(out.display());
        Ok(())
    }
}
