//! The state of the whole user interface, and actions that change several of its parts. It does not depend on a window
//! or a GPU.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::channel;

use egui::{Context, Rect};

use super::camera::SceneCamera;
use super::context::{PanelContext, Request};
use super::dialogs::{Chosen, FileDialog};
use super::ensemble::Ensemble;
use super::experiment_plot::ExperimentSeries;
use super::exports::Exports;
use super::file_names::refused_file;
use super::lessons::LESSONS;
use super::link::link_of;
use super::notice::Notice;
use super::opening::{Opening, opening_of};
use super::panels::Panels;
use super::preferences::{Preferences, StoredWindow};
use super::session::{Arrangement, arrangement_of, write_session, write_state};
use super::watched_run::WatchedRun;
use super::work::{Work, closed};
use crate::config::{Config, SavedState};
use crate::live::{Command, Live, LiveFrame, LiveStart};

/// The state of the user interface.
pub struct AppState {
    /// The visible run.
    pub run: WatchedRun,
    /// The user's choices, which the program stores between starts.
    pub preferences: Preferences,
    /// The part of the scene that is visible.
    pub camera: SceneCamera,
    /// True while a lesson is open.
    pub touring: bool,
    /// Runs with the present settings from other initial states (other seeds).
    pub ensemble: Ensemble,
    /// Values of an experiment's main quantity (such as the angle of the surface in a drum) at the displayed times, for
    /// its plot.
    pub(crate) experiment: ExperimentSeries,
    /// Positions of controls, points, for tests that control the window from outside.
    pub controls: BTreeMap<String, Rect>,
    /// The panels of the window with their own state.
    pub panels: Panels,
    /// True if the window must open its graphics device again.
    pub(crate) restart_graphics: bool,
    notice: Option<Notice>,
    exports: Exports,
    dialog: FileDialog,
    /// Layout of the panels in a session that is being opened.
    layout: Option<egui::Memory>,
    seen_loads: u64,
    seen_refusal: Option<Arc<str>>,
}

impl AppState {
    /// Returns the state at the start of the program, and begins to load `config`.
    pub fn new(live: Live, config: Config, preferences: Preferences) -> Self {
        let mut state = Self::idle(live, preferences);
        state.load(config);
        state
    }

    /// Returns the state at the start of the program, without a scene.
    pub(crate) fn idle(live: Live, preferences: Preferences) -> Self {
        let mut state = Self {
            run: WatchedRun::new(live),
            preferences,
            camera: SceneCamera::default(),
            touring: false,
            ensemble: Ensemble::new(),
            experiment: ExperimentSeries::default(),
            controls: BTreeMap::new(),
            panels: Panels::default(),
            restart_graphics: false,
            notice: None,
            exports: Exports::default(),
            dialog: FileDialog::default(),
            layout: None,
            seen_loads: 0,
            seen_refusal: None,
        };
        // If the window was closed in a lesson, the lesson's choices were stored. The user's own choices are restored
        // before something else is opened.
        state.preferences.put_lesson_away();
        state.set_pace();
        state
    }

    /// Splits the state into the context that all panels share and the panels themselves.
    pub(super) fn split(&mut self) -> (PanelContext<'_>, &mut Panels) {
        let context = PanelContext {
            run: &mut self.run,
            preferences: &mut self.preferences,
            camera: &mut self.camera,
            ensemble: &self.ensemble,
            experiment: &self.experiment,
            exports: &mut self.exports,
            notice: &mut self.notice,
            controls: &mut self.controls,
            touring: self.touring,
            requests: Vec::new(),
        };
        (context, &mut self.panels)
    }

    /// Performs the action that a panel requests.
    pub(super) fn carry_out(&mut self, context: &Context, request: Request) {
        match request {
            Request::Load(config) => self.load(*config),
            Request::LoadSaved(path) => self.load_saved(&path),
            Request::ChooseFile => self.dialog.ask(context, &self.preferences.folder, true),
            Request::ChooseFolder => self.dialog.ask(context, &self.preferences.folder, false),
            Request::Visit(at) => self.visit(at),
            Request::ForgetReleased => self.ensemble.forget_released(),
            Request::LeaveLessons => self.leave_lessons(),
            Request::SaveState => self.save_state(context),
            Request::SaveSession => self.save_session(context),
            Request::CopyLink => self.copy_link(context),
        }
    }

    /// True while a picture or another file, a recording (files of grains and contacts) or a film is being written.
    pub fn is_writing(&self) -> bool {
        self.exports.is_writing()
    }

    /// Fetches the newest frame (the data to draw) from the solver's thread. The controls show the settings in this
    /// frame, unless the user is changing a setting.
    pub(super) fn refresh(&mut self, context: &Context) {
        self.run.frame = self.run.live.latest().clone();
        self.follow_loads();
        let LiveFrame { acknowledged, start, .. } = &self.run.frame;
        if start.is_none() && *acknowledged == self.run.live.sent() {
            // The first load was cancelled or failed. The default scene is loaded instead, because its grains need no
            // deposition.
            self.load(Config::default());
        }
        // Each error message is a new allocation, so an equal text at another address is a new error.
        let refusal = self.run.frame.refusal.clone();
        let seen = std::mem::replace(&mut self.seen_refusal, refusal.clone());
        if let Some(refusal) = refusal.filter(|new| seen.is_none_or(|old| !Arc::ptr_eq(&old, new)))
        {
            self.warn(refusal.to_string());
        }
        self.run.follow_frame();
        if let Some(settings) = self.run.wanted_settings().filter(|_| !self.touring) {
            self.preferences.scene = self.run.config().with_settings(&settings);
        }
        self.panels.scene.follow(&self.run);
        self.experiment.follow(&self.run.frame);
        if let Some(notice) = self.exports.follow(context) {
            self.notice = Some(notice);
        }
        match self.dialog.answer() {
            Some(Ok(Chosen::File(path))) => self.open_file(&path),
            Some(Ok(Chosen::Folder(path))) => self.preferences.folder = path,
            Some(Err(error)) => self.warn(error.to_string()),
            None => {}
        }
        self.ensemble.follow(context, &self.run.frame, self.preferences.ensemble);
    }

    /// Resets the view and the selection if a new scene was loaded.
    fn follow_loads(&mut self) {
        if self.run.frame.loads == self.seen_loads {
            return;
        }
        self.seen_loads = self.run.frame.loads;
        self.camera.frame_scene();
        (self.run.pinned, self.run.draft) = (None, None);
        self.exports.data.stretch = None;
        self.panels.pages.forget_race();
        let start = self.run.frame.start.as_ref();
        if let Some(arrangement) = start.and_then(|start| arrangement_of(start)) {
            self.arrange(arrangement);
        }
    }

    /// Shows an error message in the status bar for a few seconds.
    pub(crate) fn warn(&mut self, text: impl Into<String>) {
        self.notice = Some(Notice::new(text, true));
    }

    /// The notice in the status bar and its remaining time, s.
    pub fn notice(&self) -> Option<(&Notice, f32)> {
        let notice = self.notice.as_ref()?;
        Some((notice, notice.left_secs()?))
    }

    fn set_pace(&mut self) {
        self.run.live.send(Command::SetPace(self.preferences.pace()));
    }

    /// Opens the scene of a configuration.
    pub fn load(&mut self, config: Config) {
        self.open(Opening::Scene(Box::new(config)));
    }

    /// Opens a saved run, so that it can be continued.
    pub fn load_run(&mut self, state: SavedState) {
        self.open(Opening::Run(Box::new(state)));
    }

    /// Opens the file of a saved run or of a session, so that it can be continued.
    pub fn load_saved(&mut self, path: &Path) {
        self.exports.data.saved_run = path.display().to_string();
        self.open(Opening::File(path.to_owned()));
    }

    /// Opens a file of any supported kind.
    pub(super) fn open_file(&mut self, path: &Path) {
        match opening_of(path) {
            Some(Opening::File(path)) => self.load_saved(&path),
            Some(opening) => self.open(opening),
            None => self.warn(refused_file(path)),
        }
    }

    /// Sends a request to open a scene, a lesson, a link (text that reproduces runs) or a file to the solver's thread.
    /// Ends the lessons, unless the request opens a lesson.
    pub(crate) fn open(&mut self, opening: Opening) {
        if !matches!(opening, Opening::Lesson(_)) {
            self.leave_lessons();
        }
        self.run.live.send(Command::Load(Box::new(opening)));
    }

    /// Opens the lesson with the index `at`, or the last lesson if `at` is too large.
    pub fn visit(&mut self, at: usize) {
        let at = at.min(LESSONS.len() - 1);
        LESSONS[at].begin(at, &mut self.preferences);
        self.touring = true;
        self.panels.lesson_bar.loads_before = self.run.frame.loads;
        self.panels.lesson_bar.shows_summary = false;
        self.set_pace();
        self.open(Opening::Lesson(at));
    }

    /// Ends the lessons. Their worlds (simulations) stay open.
    fn leave_lessons(&mut self) {
        if std::mem::take(&mut self.touring) {
            self.preferences.put_lesson_away();
            self.preferences.lesson.on = false;
            self.set_pace();
        }
    }

    /// Saves the displayed state of the selected simulation to a file.
    fn save_state(&mut self, context: &Context) {
        let run = self.run.take(self.run.selected);
        self.exports.write(context, &self.preferences.folder, vec![run], |folder, _, runs| {
            write_state(folder, runs.into_iter().next().ok_or_else(closed)?)
        });
    }

    /// Saves all simulations with their history, and the arrangement of the window, to a file.
    pub(super) fn save_session(&mut self, context: &Context) {
        if self.run.frame.worlds.is_empty() {
            return;
        }
        let stored = StoredWindow::of(&self.preferences, context);
        let (touring, selected, camera) = (self.touring, self.run.selected, self.camera);
        let arrangement = Arrangement { stored, touring, selected, camera };
        let (sender, run) = channel();
        let hand_on = move |start: LiveStart| {
            // The receiver may no longer exist.
            let _ = sender.send(start);
        };
        self.run.live.send(Command::TakeAll(Box::new(hand_on)));
        let stem = self.run.file_stem();
        let folder = &self.preferences.folder;
        self.exports.write(context, folder, vec![run], move |folder, _, runs| {
            let start = runs.into_iter().next().ok_or_else(closed)?;
            write_session(folder, &stem, start, &arrangement)
        });
    }

    /// Copies a link to the clipboard that reproduces the displayed state of all simulations.
    pub fn copy_link(&mut self, context: &Context) {
        let runs = self.run.take_all();
        self.exports.link = Some(Work::start(context, runs, |runs, _| link_of(&runs)));
    }

    /// Restores the arrangement of the window from a session, except the window's size and the folder in which file
    /// dialogs open.
    fn arrange(&mut self, arrangement: Arrangement) {
        let Arrangement { stored, touring, selected, camera } = arrangement;
        let Preferences { window_points, folder, .. } = self.preferences.clone();
        self.preferences = Preferences { window_points, folder, ..stored.preferences };
        (self.touring, self.run.selected, self.camera) = (touring, selected, camera);
        self.layout = Some(stored.layout);
        self.set_pace();
    }

    /// Restores the positions of the panels from a session.
    pub(super) fn restore_layout(&mut self, context: &Context) {
        if let Some(layout) = self.layout.take() {
            context.memory_mut(|memory| memory.data = layout.data);
            context.set_zoom_factor(layout.options.zoom_factor);
        }
    }
}
