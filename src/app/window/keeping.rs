//! The file that keeps what the window remembers between starts.
//!
//! A file that cannot be read, be it of another version, counts as none: nobody should have to
//! repair it. What cannot be written is not kept, and nothing else is lost.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::app::preferences::{Preferences, StoredWindow};
use crate::app::user_folder::user_folder;

/// Where the file lies: in the user's configuration folder.
fn path() -> Option<PathBuf> {
    Some(user_folder("XDG_CONFIG_HOME", ".config")?.join("window.ron"))
}

/// Reads what was kept.
pub(super) fn load() -> StoredWindow {
    let text = path().and_then(|path| std::fs::read_to_string(path).ok());
    text.and_then(|text| ron::from_str(&text).ok()).unwrap_or_default()
}

/// Forgets what was kept.
pub(super) fn forget() {
    if let Some(path) = path() {
        let _ = std::fs::remove_file(path);
    }
}

/// Least time between two looks at what has changed: a window that is killed loses no more than that.
const INTERVAL: Duration = Duration::from_secs(2);

/// Keeps what changes while the window is open.
pub(super) struct Keeper {
    looked: Instant,
    kept: Preferences,
    text: String,
}

impl Keeper {
    /// With what was loaded.
    pub(super) fn new(kept: Preferences) -> Self {
        Self { looked: Instant::now(), kept, text: String::new() }
    }

    /// Keeps what has changed, if it is time to look. Otherwise, where something has, how long until then.
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

    /// Keeps what has changed.
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

/// Writes a file beside and moves it, so that a crash leaves the old one or the new one, and a reader sees a whole one.
pub(super) fn replace_file(path: &Path, text: &str) {
    let fresh = path.with_extension("new");
    if std::fs::write(&fresh, text).is_ok() {
        let _ = std::fs::rename(fresh, path);
    }
}
