//! The context that panels share, and their requests to the window, which carries them out once all panels are drawn.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use egui::Rect;

use super::camera::SceneCamera;
use super::ensemble::Ensemble;
use super::experiment_plot::ExperimentSeries;
use super::exports::{Exports, Printers};
use super::notice::Notice;
use super::preferences::Preferences;
use super::watched_run::WatchedRun;
use super::work::MaySend;
use crate::config::Config;
use crate::error::Result;
use crate::live::PastRun;

/// A request of a panel.
pub(crate) enum Request {
    /// Open a scene.
    Load(Box<Config>),
    /// Open the file of a saved run or of a session.
    LoadSaved(PathBuf),
    /// Ask for a file to be opened.
    ChooseFile,
    /// Ask for the folder of saved files.
    ChooseFolder,
    /// Show a lesson.
    Visit(usize),
    /// Forget the points of Fig. 5a.
    ForgetReleased,
    /// End the lessons.
    LeaveLessons,
    /// Save the visible moment of the selected world.
    SaveState,
    /// Save the session.
    SaveSession,
    /// Copy a link to the present moment.
    CopyLink,
}

/// The state that panels share. Any other state that a panel keeps between two frames is its own.
pub(crate) struct PanelContext<'a> {
    pub run: &'a mut WatchedRun,
    pub preferences: &'a mut Preferences,
    pub camera: &'a mut SceneCamera,
    pub ensemble: &'a Ensemble,
    pub experiment: &'a ExperimentSeries,
    pub exports: &'a mut Exports,
    pub notice: &'a mut Option<Notice>,
    pub controls: &'a mut BTreeMap<String, Rect>,
    /// True in a lesson.
    pub touring: bool,
    pub requests: Vec<Request>,
}

impl PanelContext<'_> {
    /// Sends a request to the window.
    pub(crate) fn ask(&mut self, request: Request) {
        self.requests.push(request);
    }

    /// Shows a failure in the status bar for a while.
    pub(crate) fn warn(&mut self, text: impl Into<String>) {
        *self.notice = Some(Notice::new(text, true));
    }

    /// Writes a file into the folder of the preferences on another thread. The job returns the path.
    pub(crate) fn write(
        &mut self,
        context: &egui::Context,
        job: impl FnOnce(&Path, &mut Printers) -> Result<PathBuf> + MaySend + 'static,
    ) {
        let job = |folder: &Path, printers: &mut Printers, _: Vec<()>| job(folder, printers);
        self.exports.write(context, &self.preferences.folder, Vec::new(), job);
    }

    /// Stores the place of a control.
    pub(crate) fn note_control(&mut self, name: &str, rect: Rect) {
        self.controls.insert(name.to_owned(), rect);
    }

    /// The earlier run that is drawn behind the present one.
    pub(crate) fn ghost(&self) -> Option<&PastRun> {
        self.run.ghost().filter(|_| self.preferences.ghost)
    }
}
