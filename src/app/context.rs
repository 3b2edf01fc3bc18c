//! The state that all panels of the window share, and the requests of the panels to the window. The window performs the
//! requests after all panels are drawn.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use egui::Rect;

use super::camera::SceneCamera;
use super::ensemble::Ensemble;
use super::experiment_plot::ExperimentSeries;
use super::exports::{Exports, Printers};
use super::file_names::free_path;
use super::notice::Notice;
use super::preferences::Preferences;
use super::watched_run::WatchedRun;
use super::work::MaySend;
use crate::config::Config;
use crate::error::Result;
use crate::live::PastRun;

/// A request of a panel to the window.
pub(crate) enum Request {
    /// Open the scene of a configuration.
    Load(Box<Config>),
    /// Open the file of a saved run or of a session.
    LoadSaved(PathBuf),
    /// Show a dialog in which the user chooses a file to be opened.
    ChooseFile,
    /// Show a dialog in which the user chooses the folder of saved files.
    ChooseFolder,
    /// Open the lesson with this index.
    Visit(usize),
    /// Remove the points of the plot of slump against Δt (Fig. 5a of Abramian & Staron 2020).
    ForgetReleased,
    /// End the lessons.
    LeaveLessons,
    /// Save the displayed state of the selected simulation.
    SaveState,
    /// Save the session: all simulations with their history, and the arrangement of the window.
    SaveSession,
    /// Copy a link to the clipboard that reproduces the run up to the displayed simulated time.
    CopyLink,
}

/// State that all panels of the window share. State that only one panel needs between two frames belongs to that panel.
pub(crate) struct PanelContext<'a> {
    pub run: &'a mut WatchedRun,
    pub preferences: &'a mut Preferences,
    pub camera: &'a mut SceneCamera,
    pub ensemble: &'a Ensemble,
    pub experiment: &'a ExperimentSeries,
    pub exports: &'a mut Exports,
    pub notice: &'a mut Option<Notice>,
    pub controls: &'a mut BTreeMap<String, Rect>,
    /// True while a lesson is open.
    pub touring: bool,
    pub requests: Vec<Request>,
}

impl PanelContext<'_> {
    /// Sends a request to the window.
    pub(crate) fn ask(&mut self, request: Request) {
        self.requests.push(request);
    }

    /// Shows an error message in the status bar for a few seconds.
    pub(crate) fn warn(&mut self, text: impl Into<String>) {
        *self.notice = Some(Notice::new(text, true));
    }

    /// Writes the file `stem.ending` on another thread, into the folder that the preferences name. If this file exists
    /// already, a number is added to its name. `job` writes the file with the given path.
    pub(crate) fn write(
        &mut self,
        context: &egui::Context,
        stem: String,
        ending: &'static str,
        job: impl FnOnce(&Path, &mut Printers) -> Result<()> + MaySend + 'static,
    ) {
        let job = move |folder: &Path, printers: &mut Printers, _: Vec<()>| {
            let path = free_path(folder, &stem, ending);
            job(&path, printers).map(|()| path)
        };
        self.exports.write(context, &self.preferences.folder, Vec::new(), job);
    }

    /// Stores the rectangle `rect` (points) of the control `name`, for tests that control the window from outside.
    pub(crate) fn note_control(&mut self, name: &str, rect: Rect) {
        self.controls.insert(name.to_owned(), rect);
    }

    /// The earlier run that is drawn behind the present run; `None` without an earlier run or if the user hides it.
    pub(crate) fn ghost(&self) -> Option<&PastRun> {
        self.run.ghost().filter(|_| self.preferences.ghost)
    }
}
