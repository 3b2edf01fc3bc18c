//! The file in which the window stores its preferences between starts.
//!
//! A file that cannot be read, for example a file of another version, is ignored, so that nobody must repair it. If the
//! file cannot be written, only the changed preferences are lost.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::app::preferences::{Preferences, StoredWindow};
use crate::app::user_folder::user_folder;

/// Path of the file with the preferences, in the user's configuration folder.
fn path() -> Option<PathBuf> {
    Some(user_folder("XDG_CONFIG_HOME", ".config")?.join("window.ron"))
}

/// Reads the stored preferences and layout.
pub(super) fn load() -> StoredWindow {
    let text = path().and_then(|path| std::fs::read_to_string(path).ok());
    text.and_then(|text| ron::from_str(&text).ok()).unwrap_or_default()
}

/// Deletes the file with the preferences.
pub(super) fn forget() {
    if let Some(path) = path() {
        let _ = std::fs::remove_file(path);
    }
}

/// Time between two checks for changed preferences. If the window is killed, at most the changes of this period are
/// lost.
const INTERVAL: Duration = Duration::from_secs(2);

/// Stores changed preferences while the window is open.
pub(super) struct Keeper {
    looked: Instant,
    kept: Preferences,
    text: String,
}

impl Keeper {
    /// Returns a keeper that stores preferences if they differ from `kept`, the preferences that were loaded.
    pub(super) fn new(kept: Preferences) -> Self {
        Self { looked: Instant::now(), kept, text: String::new() }
    }

    /// Stores the preferences if a check is due. If the preferences have changed but no check is due, returns the time
    /// until the next check.
    pub(super) fn look(
        &mut self,
        preferences: &Preferences,
        context: &egui::Context,
    ) -> Option<Duration> {
        let left = INTERVAL.saturating_sub(self.looked.elapsed());
        if !left.is_zero() {
            return (*preferences != self.kept).then_some(left);
        }
        self.keep(preferences, context);
        None
    }

    /// Stores the preferences and the layout now, if the text of their file would change.
    pub(super) fn keep(&mut self, preferences: &Preferences, context: &egui::Context) {
        self.looked = Instant::now();
        self.kept.clone_from(preferences);
        let stored = StoredWindow::of(preferences, context);
        let Ok(text) = ron::to_string(&stored) else { return };
        if let Some(path) = path().filter(|_| text != self.text) {
            let _ = path.parent().map(std::fs::create_dir_all);
            replace_file(&path, &text);
            self.text = text;
        }
    }
}

/// Replaces a file: writes a new file and renames it to the name of the old file. After a crash either the old or the
/// new file exists, and readers always see a complete file.
pub(super) fn replace_file(path: &Path, text: &str) {
    let fresh = path.with_extension("new");
    if std::fs::write(&fresh, text).is_ok() {
        let _ = std::fs::rename(fresh, path);
    }
}
