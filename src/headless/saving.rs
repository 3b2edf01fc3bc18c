//! Options of runs that are saved and gone on with.

use std::path::PathBuf;

use crate::error::{Error, Result};

/// Options of runs that are saved and gone on with.
#[derive(Clone, Debug, Default, clap::Args)]
pub(crate) struct SavingOptions {
    /// Go on with a saved run: simulated time, slump and the numbers of pictures go on, and settings given besides change it from there on (--initial begins a new run at t = 0 with its grains)
    #[arg(long, value_name = "FILE", help_heading = "Saved runs")]
    pub restart: Option<PathBuf>,
    /// Save the run at its end, a signal's too, unless its state is no longer finite
    #[arg(long, value_name = "FILE", help_heading = "Saved runs", requires = "headless")]
    pub save: Option<PathBuf>,
    /// Save the run each so many simulated seconds, as checkpoint.slump beside the frames: the same command, given again after whatever stopped it, goes on from there (--overwrite begins anew)
    #[arg(
        long,
        value_name = "SECONDS",
        help_heading = "Saved runs",
        requires_all = ["headless", "frames"],
        allow_negative_numbers = true
    )]
    pub checkpoint_every: Option<f64>,
}

impl SavingOptions {
    /// Checks what can be checked before anything is read.
    ///
    /// # Errors
    /// Where the time between checkpoints is none.
    pub(super) fn validate(&self) -> Result<()> {
        match self.checkpoint_every {
            Some(secs) if !(secs > 0.0 && secs.is_finite()) => {
                Err(Error::value("checkpoint-every", secs, "a finite number of seconds > 0"))
            }
            _ => Ok(()),
        }
    }
}
