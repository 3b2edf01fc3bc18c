//! `slump scene`: a scene, with changes, as a file.

use crate::config::{Config, scene_to_toml};
use crate::error::Result;
use crate::headless::settled;
use crate::output::print_text;

/// Arguments of `slump scene`.
#[derive(clap::Args)]
pub(super) struct SceneCommand {
    #[command(flatten)]
    config: Config,
}

impl SceneCommand {
    /// Does what is asked.
    pub(super) fn run(&self) -> Result<()> {
        print_text(scene_to_toml(&settled(&self.config)?)?);
        Ok(())
    }
}
