//! `slump` without a command: a scene, in the window or drawn without one.

#[cfg(feature = "window")]
use crate::app::WindowOptions;
use crate::config::Config;
#[cfg(not(feature = "window"))]
use crate::error::Error;
use crate::error::Result;
use crate::headless::HeadlessOptions;

/// Arguments of `slump`.
#[derive(clap::Args)]
pub(super) struct RunCommand {
    #[command(flatten)]
    config: Config,
    #[command(flatten)]
    headless: HeadlessOptions,
    #[cfg(feature = "window")]
    #[command(flatten)]
    window: WindowOptions,
}

impl RunCommand {
    /// Does what is asked.
    pub(super) fn run(&self) -> Result<()> {
        if self.headless.headless {
            return crate::headless::run(&self.config, &self.headless);
        }
        self.open_window()
    }

    #[cfg(feature = "window")]
    fn open_window(&self) -> Result<()> {
        crate::app::run(&self.config, &self.headless, &self.window)
    }

    #[cfg(not(feature = "window"))]
    fn open_window(&self) -> Result<()> {
        Err(Error::Renderer(
            "this build has no window: build it with the feature window, or give --headless".into(),
        ))
    }
}
