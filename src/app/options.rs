//! What the command line says about the window itself.

use std::path::PathBuf;

/// Options of the window. The scene, its physics and its solver are in [`crate::config::Config`].
#[derive(Clone, Debug, Default, PartialEq, clap::Args)]
pub(crate) struct WindowOptions {
    /// Forget the window's layout, theme and last scene
    #[arg(long, help_heading = "Window")]
    pub reset_ui: bool,
    /// Open a session that the window saved: worlds, record and arrangement
    #[arg(long, value_name = "FILE", help_heading = "Window", conflicts_with_all = ["headless", "restart", "open"])]
    pub session: Option<PathBuf>,
    /// Open the line that Copy link gave, slump://run?…
    #[arg(long, value_name = "LINK", help_heading = "Window", conflicts_with_all = ["headless", "restart"])]
    pub open: Option<String>,
    /// Keep writing the state of window and run to this file, as JSON: for tests
    #[arg(long, value_name = "FILE", hide = true)]
    pub export_state: Option<PathBuf>,
}
