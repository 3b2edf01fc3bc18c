//! A session: all worlds with their history, and the window as it was arranged, as one file; and the file of a saved run.
//!
//! What is computed is kept as live runs keep it, thinned: the start, some moments on the way, every change
//! of the settings, and the moment that was shown. So it opens at once, and the moments between are computed
//! again, bit for bit, where the timeline asks for them.

use std::path::Path;
use std::sync::mpsc::channel;

use serde::{Deserialize, Serialize};

use super::camera::SceneCamera;
use super::export::{free_path, write_state};
use super::opening::Opened;
use super::panels::see::file_stem;
use super::preferences::{Preferences, StoredWindow};
use super::state::AppState;
use crate::config::Config;
use crate::error::{Error, Result};
use crate::live::{Command, LiveStart};
use crate::output::{Seal, write_file};
use crate::scene::Scene;

/// What files begin with.
const SEAL: Seal = Seal {
    magic: "slump-session ",
    format: 2,
    what: "session",
    of: "",
    form: "a session that the window saved",
};

/// Ending of files that sessions are saved to.
pub(crate) const SESSION_ENDING: &str = "session";

/// How a window is arranged.
#[derive(Clone, Serialize, Deserialize)]
pub(crate) struct Arrangement {
    /// Choices, and where panels are.
    pub stored: StoredWindow,
    /// Whether the tour is being taken.
    pub touring: bool,
    /// The world that the controls are about.
    pub selected: usize,
    /// What of the scene shows.
    pub camera: SceneCamera,
}

/// What is in a file.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Session {
    start: LiveStart,
    scene: Scene,
    /// What opens the scene again, as JSON.
    config: String,
    /// The [`Arrangement`], as RON.
    window: String,
}

impl Session {
    /// Reads a file.
    ///
    /// # Errors
    /// Where it cannot be read, is damaged or of another version, or is no such file.
    pub(crate) fn open(path: &Path) -> Result<Self> {
        let session: Self = SEAL.open(path)?;
        let is_sound = session.start.history.as_ref().is_some_and(|history| history.is_sound());
        if is_sound && session.parts().is_some() {
            return Ok(session);
        }
        Err(Error::file(path, format!("holds no whole session, but must be {}", SEAL.form)))
    }

    /// What is text in it.
    fn parts(&self) -> Option<(Config, Arrangement)> {
        Some((serde_json::from_str(&self.config).ok()?, ron::from_str(&self.window).ok()?))
    }

    /// Writes a file.
    ///
    /// # Errors
    /// Names the file and what the system says, or why the run cannot be saved.
    fn save(start: LiveStart, opened: &Opened, window: String, path: &Path) -> Result<()> {
        if start.history.as_ref().is_some_and(|history| history.failure().is_some()) {
            let allowed = "an earlier one: drag the timeline back";
            return Err(Error::value("state", "no longer finite", allowed));
        }
        let Opened { scene, config } = opened;
        let refuse = |error| Error::value("scene", &scene.name, format!("written ({error})"));
        let config = serde_json::to_string(config).map_err(refuse)?;
        let session = Self { start, scene: scene.clone(), config, window };
        write_file(path, &SEAL.written(&session)?)
    }

    /// The start, what it is of, and how the window was arranged.
    ///
    /// # Errors
    /// Where what is text in it is none.
    pub(super) fn into_parts(self) -> Result<(LiveStart, Opened, Arrangement)> {
        let refuse = || Error::value("session", "damaged", SEAL.form);
        let (config, arrangement) = self.parts().ok_or_else(refuse)?;
        Ok((self.start, Opened { scene: self.scene, config }, arrangement))
    }
}

impl AppState {
    /// Saves the moment that the selected world has come to.
    pub(crate) fn save_state(&mut self, context: &egui::Context) {
        let run = self.take_run();
        self.export(context, move |folder, _| write_state(folder, &run));
    }

    /// Saves all worlds with their history, and how the window is arranged.
    pub(crate) fn save_session(&mut self, context: &egui::Context) {
        if self.frame.worlds.is_empty() {
            return;
        }
        let preferences = self.preferences.clone();
        let stored = StoredWindow { preferences, layout: context.memory(Clone::clone) };
        let Self { touring, selected, camera, .. } = *self;
        let window = match ron::to_string(&Arrangement { stored, touring, selected, camera }) {
            Ok(window) => window,
            Err(error) => {
                let allowed = format!("written ({error})");
                return self.warn(Error::value("window", "arranged so", allowed).to_string());
            }
        };
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
            let run = run.recv();
            let (start, opened) =
                run.map_err(|_| Error::value("run", "closed", "open when its session is saved"))?;
            Session::save(start, &opened, window, &path)?;
            Ok(path)
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
