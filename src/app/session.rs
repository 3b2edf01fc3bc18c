//! A session: all worlds with their history, and the window as it was arranged, as one file; and the file of a saved run.
//!
//! What is computed is kept as live runs keep it, thinned: the start, some moments on the way, every change
//! of the settings, and the moment that was shown. So it opens at once, and the moments between are computed
//! again, bit for bit, where the timeline asks for them.

use std::path::Path;
use std::sync::mpsc::channel;

use serde::{Deserialize, Serialize};

use super::camera::SceneCamera;
use super::export::{not_finite, write_state};
use super::file_names::{SESSION_ENDING, free_path};
use super::panels::see::file_stem;
use super::preferences::{Preferences, StoredWindow};
use super::state::AppState;
use super::work::closed;
use crate::error::{Error, Result};
use crate::live::{Command, LiveStart};
use crate::output::{Seal, write_file};

/// What files begin with.
const SEAL: Seal = Seal {
    magic: "slump-session ",
    format: 6,
    what: "session",
    of: "",
    form: "a session that the window saved",
};

/// How a window is arranged.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Arrangement {
    pub stored: StoredWindow,
    pub touring: bool,
    pub selected: usize,
    pub camera: SceneCamera,
}

/// Reads a file: the start, with how the window was arranged.
pub(super) fn open_session(path: &Path) -> Result<LiveStart> {
    let start: LiveStart = SEAL.open(path)?;
    let is_sound = start.history.as_ref().is_some_and(|history| history.is_sound());
    if !is_sound || arrangement_of(&start).is_none() {
        let reason = format!("holds no whole session, but must be {}", SEAL.form);
        return Err(Error::file(path, reason));
    }
    Ok(start)
}

/// How the window is to be arranged; nothing where the start is of no session.
pub(super) fn arrangement_of(start: &LiveStart) -> Option<Arrangement> {
    ron::from_str(start.window.as_ref()?).ok()
}

/// Writes a file.
fn save(start: &LiveStart, path: &Path) -> Result<()> {
    if start.history.as_ref().is_some_and(|history| history.failure().is_some()) {
        return Err(not_finite());
    }
    write_file(path, &SEAL.written(start)?)
}

impl AppState {
    /// Saves the moment that the selected world has come to.
    pub(crate) fn save_state(&mut self, context: &egui::Context) {
        let run = self.take_run(self.selected);
        self.export_run(context, vec![run], |folder, _, mut runs| {
            write_state(folder, runs.pop().ok_or_else(closed)?)
        });
    }

    /// Saves all worlds with their history, and how the window is arranged.
    pub(crate) fn save_session(&mut self, context: &egui::Context) {
        if self.frame.worlds.is_empty() {
            return;
        }
        let stored = StoredWindow::of(&self.preferences, context);
        let Self { touring, selected, camera, .. } = *self;
        let arrangement = Arrangement { stored, touring, selected, camera };
        let (sender, run) = channel();
        let hand_on = move |start: LiveStart| {
            // Whoever asked may have gone.
            let _ = sender.send(start);
        };
        self.live.send(Command::TakeAll(Box::new(hand_on)));
        let stem = file_stem(self);
        self.export_run(context, vec![run], move |folder, _, mut runs| {
            let path = free_path(folder, &stem, SESSION_ENDING);
            let refuse =
                |error| Error::value("window", "arranged so", format!("written ({error})"));
            let window = ron::to_string(&arrangement).map_err(refuse)?;
            let start = LiveStart { window: Some(window), ..runs.pop().ok_or_else(closed)? };
            save(&start, &path).map(|()| path)
        });
    }

    /// Arranges the window as it was when a session was saved. What belongs to this window and its user stays:
    /// its size, and where files go.
    pub(super) fn arrange(&mut self, arrangement: Arrangement) {
        let Arrangement { stored, touring, selected, camera } = arrangement;
        let Preferences { window_points, folder, .. } = self.preferences.clone();
        self.preferences = Preferences { window_points, folder, ..stored.preferences };
        (self.touring, self.selected, self.camera) = (touring, selected, camera);
        self.opening.layout = Some(stored.layout);
        self.live.send(Command::SetPace(self.preferences.pace()));
    }

    /// Puts the panels where they were when a session was saved.
    pub(super) fn restore_layout(&mut self, context: &egui::Context) {
        if let Some(layout) = self.opening.layout.take() {
            context.memory_mut(|memory| memory.data = layout.data);
            context.set_zoom_factor(layout.options.zoom_factor);
        }
    }
}
