//! A session: all worlds with their history, and the window as it was arranged, as one file; and the file of a saved run.
//!
//! What is computed is kept as live runs keep it, thinned: the start, some moments on the way, every change
//! of the settings, and the moment that was shown. So it opens at once, and the moments between are computed
//! again, bit for bit, where the timeline asks for them.

use std::path::Path;
use std::sync::mpsc::channel;

use serde::{Deserialize, Serialize};

use super::camera::SceneCamera;
use super::export::{free_path, not_finite, write_state};
use super::opening::Opened;
use super::panels::see::file_stem;
use super::preferences::{Preferences, StoredWindow};
use super::state::AppState;
use super::work::received;
use crate::error::{Error, Result};
use crate::live::{Command, LiveStart};
use crate::output::{Seal, write_file};
use crate::scene::Scene;

/// What files begin with.
const SEAL: Seal = Seal {
    magic: "slump-session ",
    format: 3,
    what: "session",
    of: "",
    form: "a session that the window saved",
};

/// Ending of files that sessions are saved to.
pub(crate) const SESSION_ENDING: &str = "session";

/// How a window is arranged.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Arrangement {
    pub stored: StoredWindow,
    pub touring: bool,
    pub selected: usize,
    pub camera: SceneCamera,
}

/// What is in a file.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Session {
    start: LiveStart,
    scene: Scene,
    /// What opens the scene again, as JSON.
    config: String,
    /// The [`Arrangement`], as RON.
    window: String,
}

/// Reads a file: the start, and what it is of with how the window was arranged.
pub(super) fn open_session(path: &Path) -> Result<(LiveStart, Opened)> {
    let Session { start, scene, config, window } = SEAL.open(path)?;
    let is_sound = start.history.as_ref().is_some_and(|history| history.is_sound());
    match (serde_json::from_str(&config), ron::from_str(&window)) {
        (Ok(config), Ok(arrangement)) if is_sound => {
            Ok((start, Opened { scene, config, arrangement: Some(arrangement) }))
        }
        _ => Err(Error::file(path, format!("holds no whole session, but must be {}", SEAL.form))),
    }
}

/// Writes a file.
fn save(start: LiveStart, opened: &Opened, window: String, path: &Path) -> Result<()> {
    if start.history.as_ref().is_some_and(|history| history.failure().is_some()) {
        return Err(not_finite());
    }
    let Opened { scene, config, .. } = opened;
    let refuse = |error| Error::value("scene", &scene.name, format!("written ({error})"));
    let config = serde_json::to_string(config).map_err(refuse)?;
    let session = Session { start, scene: scene.clone(), config, window };
    write_file(path, &SEAL.written(&session)?)
}

impl AppState {
    /// Saves the moment that the selected world has come to.
    pub(crate) fn save_state(&mut self, context: &egui::Context) {
        let run = self.take_run(self.selected);
        self.export(context, move |folder, _| write_state(folder, &run));
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
        let last = self.opening.last.clone();
        let hand_on = move |start: LiveStart| {
            if let Some(opened) = last.get() {
                // Whoever asked may have gone.
                let _ = sender.send((start, opened));
            }
        };
        self.live.send(Command::TakeAll(Box::new(hand_on)));
        let stem = file_stem(self);
        self.export(context, move |folder, _| {
            let path = free_path(folder, &stem, SESSION_ENDING);
            let refuse =
                |error| Error::value("window", "arranged so", format!("written ({error})"));
            let window = ron::to_string(&arrangement).map_err(refuse)?;
            let (start, opened) = received(&run)?;
            save(start, &opened, window, &path).map(|()| path)
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
