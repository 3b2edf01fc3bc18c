//! Files that keep a run or a session: written, and opened again.

use std::path::Path;
use std::sync::mpsc::channel;

use super::export::Export;
use super::loader::{loader_of_file, loader_of_run, loader_of_session};
use super::panels::picture::file_stem;
use super::preferences::Preferences;
use super::session::{Arrangement, SESSION_ENDING, Session, SessionOrder};
use super::state::AppState;
use super::storage::Stored;
use super::taken::Opened;
use crate::config::SavedState;
use crate::error::{Error, Result};
use crate::live::{Command, Start};

impl AppState {
    /// Opens a saved run, to go on with it.
    pub fn load_run(&mut self, state: SavedState) {
        self.leave_tour();
        self.live.send(Command::Load(loader_of_run(state, self.last_opened.clone())));
    }

    /// Opens a session.
    pub(crate) fn load_session(
        &mut self,
        session: impl FnOnce() -> Result<Session> + Send + 'static,
    ) {
        self.leave_tour();
        let (sender, arriving) = channel();
        self.arriving = Some(arriving);
        let loader = loader_of_session(session, self.last_opened.clone(), sender);
        self.live.send(Command::Load(loader));
    }

    /// Opens the file of a saved run or of a session, to go on with it.
    pub fn load_saved(&mut self, path: &Path) {
        self.data.saved_run = path.display().to_string();
        if path.extension().is_some_and(|ending| ending == SESSION_ENDING) {
            let path = path.to_owned();
            return self.load_session(move || Session::open(&path));
        }
        self.leave_tour();
        let loader = loader_of_file(path.to_owned(), self.last_opened.clone());
        self.live.send(Command::Load(loader));
    }

    /// Saves the moment that the selected world has come to.
    pub(crate) fn save_state(&mut self, context: &egui::Context) {
        let run = self.take_run();
        let folder = self.preferences.folder.clone();
        self.exporter.submit(context, Export::State(run), &folder, "");
    }

    /// Saves all worlds with their record, and how the window is arranged.
    pub(crate) fn save_session(&mut self, context: &egui::Context) {
        if self.frame.worlds.is_empty() {
            return;
        }
        let order = match self.session_order(context) {
            Ok(order) => order,
            Err(error) => return self.warn(error.to_string()),
        };
        let (folder, stem) = (self.preferences.folder.clone(), file_stem(self));
        self.exporter.submit(context, Export::Session(Box::new(order)), &folder, &stem);
    }

    /// What a session of the present moment is made of.
    ///
    /// # Errors
    /// Where the window's arrangement cannot be said as text.
    fn session_order(&mut self, context: &egui::Context) -> Result<SessionOrder> {
        let arrangement = Arrangement {
            stored: Stored {
                preferences: self.preferences.clone(),
                layout: context.memory(Clone::clone),
            },
            touring: self.touring,
            selected: self.selected,
            camera: self.camera,
        };
        let refuse = |error| Error::value("window", "arranged so", format!("written ({error})"));
        let window = ron::to_string(&arrangement).map_err(refuse)?;
        let (sender, run) = channel();
        let last = self.last_opened.clone();
        let hand_on = move |start: Start| {
            if let Some(opened) = last.get() {
                let Opened { scene, config } = &*opened;
                // Whoever asked may have gone.
                let _ =
                    sender.send((start, Opened { scene: scene.clone(), config: config.clone() }));
            }
        };
        self.live.send(Command::TakeAll(Box::new(hand_on)));
        Ok(SessionOrder { run, window })
    }

    /// Arranges the window as it was when a session was saved. What belongs to this window and its user stays:
    /// its size, and where files go.
    pub(super) fn arrange(&mut self, arrangement: Arrangement) {
        let Arrangement { stored, touring, selected, camera } = arrangement;
        let Preferences { window_points, folder, .. } = self.preferences.clone();
        self.preferences = Preferences { window_points, folder, ..stored.preferences };
        (self.touring, self.selected, self.camera) = (touring, selected, camera);
        self.layout = Some(stored.layout);
        self.live.send(Command::SetPace(self.preferences.pace()));
    }

    /// Puts the panels where they were when a session was saved.
    pub(super) fn restore_layout(&mut self, context: &egui::Context) {
        if let Some(layout) = self.layout.take() {
            context.memory_mut(|memory| memory.data = layout.data);
            context.set_zoom_factor(layout.options.zoom_factor);
        }
    }
}
