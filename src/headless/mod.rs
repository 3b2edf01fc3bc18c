//! Runs without a window, which draw the figures of Abramian & Staron (2020) or pictures of one scene.

mod figures;
mod folder;
mod manifest;
mod options;
mod run;
mod table;
mod waiting;
mod writer;

pub(crate) use options::HeadlessOptions;
pub(crate) use run::settled;
#[cfg(feature = "panels")]
pub(crate) use {waiting::WaitingStates, writer::recording_sentence};

use std::path::Path;

use crate::config::Config;
use crate::error::Result;
use crate::output::heed_signals;
use folder::EarlierFiles;

/// Draws Figs. 3, 4 and 7 of Abramian & Staron (2020) into a folder, with any available renderer.
///
/// # Errors
/// If the folder cannot be written to.
pub(crate) fn draw_snapshots(folder: &Path) -> Result<()> {
    figures::draw(folder, EarlierFiles::Kept, HeadlessOptions::default().renderer)
}

/// Runs the scene of `config` and writes the outputs that `options` name. If `options` name only a folder for pictures,
/// draws Figs. 3, 4 and 7 of Abramian & Staron (2020) instead.
pub(crate) fn run(config: &Config, options: &HeadlessOptions) -> Result<()> {
    heed_signals();
    let earlier = if options.overwrite { EarlierFiles::Cleared } else { EarlierFiles::Refused };
    match &options.frames {
        Some(folder) if config.is_empty() && !options.asks_for_frames() => {
            figures::draw(folder, earlier, options.renderer)
        }
        _ => run::draw(config, options, earlier),
    }
}
