//! The file that keeps the window's state between starts.
//!
//! A file that cannot be read, be it of another version, counts as none: nobody should have to
//! repair it. What cannot be written is not kept, and nothing else is lost.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use super::preferences::Preferences;

/// What is kept.
#[derive(Clone, Default, Serialize, Deserialize)]
#[serde(default)]
pub(super) struct Stored {
    /// The user's choices.
    pub preferences: Preferences,
    /// Which panels are open, and how large.
    pub layout: egui::Memory,
}

/// Where the file lies: in the user's configuration folder.
fn path() -> Option<PathBuf> {
    let folder =
        std::env::var_os("XDG_CONFIG_HOME").map(PathBuf::from).filter(|path| path.is_absolute());
    let home = || std::env::home_dir().map(|home| home.join(".config"));
    Some(folder.or_else(home)?.join("slump").join("window.ron"))
}

/// Reads what was kept.
pub(super) fn load() -> Stored {
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
        let layout = context.memory(Clone::clone);
        let Ok(text) = ron::to_string(&Stored { preferences: preferences.clone(), layout }) else {
            return;
        };
        if text != self.text {
            save(&text);
            self.text = text;
        }
    }
}

fn save(text: &str) {
    let Some(path) = path() else { return };
    if let Some(folder) = path.parent() {
        let _ = std::fs::create_dir_all(folder);
    }
    // Written beside and moved, so that a crash leaves the old file or the new one.
    let fresh = path.with_extension("new");
    if std::fs::write(&fresh, text).is_ok() {
        let _ = std::fs::rename(fresh, path);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_kept_reads_back() {
        // A context that has drawn something, so that there is a layout to be kept.
        let context = egui::Context::default();
        for _ in 0..2 {
            let _ = context.run_ui(egui::RawInput::default(), |ui| {
                egui::Panel::left("side").show(ui, |ui| ui.collapsing("more", |ui| ui.label("x")));
                egui::ScrollArea::vertical().show(ui, |ui| ui.label("y"));
            });
        }
        let mut stored = Stored::default();
        stored.preferences.speed = 0.5;
        stored.preferences.scene.source.grains = Some(40);
        stored.layout = context.memory(Clone::clone);
        let text = ron::to_string(&stored).unwrap();
        let back: Stored = ron::from_str(&text).unwrap();
        assert_eq!(back.preferences, stored.preferences);
    }
}
