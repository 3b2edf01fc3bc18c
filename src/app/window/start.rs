//! What has to be settled before a window opens.

use std::path::Path;

use crate::app::storage::Stored;
use crate::error::{Error, Result};
use crate::scene::{Config, SavedState};

/// What is opened first: what the command line asks for, or the last scene, or the default one where
/// that is gone. A saved run that is to go on is opened in its place.
pub(super) fn start_config(
    asked: &Config,
    restart: Option<&Path>,
    stored: &Stored,
) -> Result<(Config, Option<SavedState>)> {
    if let Some(path) = restart {
        let mut saved = SavedState::open(path)?;
        asked.change_state(&mut saved)?;
        return Ok((Config::default(), Some(saved)));
    }
    // A pile is made on the solver's thread; everything else of a scene is checked before a window
    // opens.
    if !asked.is_empty() {
        asked.without_settling()?;
        return Ok((asked.clone(), None));
    }
    let last = &stored.preferences.scene;
    let is_there = last.without_settling().is_ok();
    Ok((if is_there { last.clone() } else { Config::default() }, None))
}

/// What is missing where no window can be opened, and what brings it.
pub(super) fn no_display(error: &dyn std::fmt::Display) -> Error {
    let message = error.to_string();
    // winit puts the places in its own source in front.
    let reason = message.rsplit(": ").next().unwrap_or(&message).trim_end_matches('.');
    Error::Renderer(format!(
        "no window can be opened ({reason}): start Slump on a desktop, or install the Debian \
         packages libx11-6, libxcursor1, libxi6, libxkbcommon-x11-0 and libx11-xcb1 for X11, or \
         libwayland-client0 and libxkbcommon0 for Wayland; --headless needs none of them"
    ))
}
