//! What the command line says about the window itself.

use std::path::PathBuf;

/// Options of the window. The scene, its physics and its solver are in [`crate::scene::Config`].
#[derive(Clone, Debug, Default, PartialEq, clap::Args)]
pub(crate) struct WindowOptions {
    /// Forget the window's layout, theme and last scene
    #[arg(long, help_heading = "Window")]
    pub reset_ui: bool,
    /// Keep writing the state of window and run to this file, as JSON: for tests
    #[arg(long, value_name = "FILE", hide = true)]
    pub export_state: Option<PathBuf>,
}
