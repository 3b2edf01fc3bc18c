//! The state of the user interface as a whole, and actions that change more than one of its parts. Knows neither window
//! nor GPU.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::channel;

use egui::{Context, Rect};

use super::camera::SceneCamera;
use super::context::{PanelContext, Request};
use super::ensemble::Ensemble;
use super::exports::Exports;
use super::lessons::LESSONS;
use super::notice::Notice;
use super::opening::Opening;
use super::panels::Panels;
use super::preferences::{Preferences, StoredWindow};
use super::session::{Arrangement, arrangement_of, write_session, write_state};
use super::watched_run::WatchedRun;
use super::work::closed;
use crate::config::{Config, SavedState};
use crate::live::{Command, Live, LiveFrame, LiveStart};

/// The state of the user interface.
pub struct AppState {
    /// The run that is shown.
    pub run: WatchedRun,
    /// What outlives the window.
    pub preferences: Preferences,
    /// Which part of the scene shows.
    pub camera: SceneCamera,
    /// True in a lesson.
    pub touring: bool,
    /// What the present settings make of other piles.
    pub ensemble: Ensemble,
    /// Where controls lie, points: for tests that drive the window from outside.
    pub controls: BTreeMap<String, Rect>,
    /// The panels, with the state that each has to itself.
    pub panels: Panels,
    /// Set if the window is to open its graphics device again.
    pub(crate) restart_graphics: bool,
    notice: Option<Notice>,
    exports: Exports,
    /// How the panels of a session that is being opened lay.
    layout: Option<egui::Memory>,
    seen_loads: u64,
    seen_refusal: Option<Arc<str>>,
}

impl AppState {
    /// The state at the start of the program; loading `config` begins.
    pub fn new(live: Live, config: Config, preferences: Preferences) -> Self {
        let mut state = Self::idle(live, preferences);
        state.load(config);
        state
    }

    /// The same, with nothing loaded.
    pub(crate) fn idle(live: Live, preferences: Preferences) -> Self {
        let mut state = Self {
            run: WatchedRun::new(live),
            preferences,
            camera: SceneCamera::default(),
            touring: false,
            ensemble: Ensemble::new(),
            controls: BTreeMap::new(),
            panels: Panels::default(),
            restart_graphics: false,
            notice: None,
            exports: Exports::default(),
            layout: None,
            seen_loads: 0,
            seen_refusal: None,
        };
        // A window that was closed in a lesson and is opened for something else has the user's own choices.
        state.preferences.put_lesson_away();
        state.set_pace();
        state
    }

    /// The context that the panels share, and the panels.
    pub(super) fn split(&mut self) -> (PanelContext<'_>, &mut Panels) {
        let context = PanelContext {
            run: &mut self.run,
            preferences: &mut self.preferences,
            camera: &mut self.camera,
            ensemble: &self.ensemble,
            exports: &mut self.exports,
            notice: &mut self.notice,
            controls: &mut self.controls,
            touring: self.touring,
            requests: Vec::new(),
        };
        (context, &mut self.panels)
    }

    /// Carries out the request of a panel.
    pub(super) fn carry_out(&mut self, context: &Context, request: Request) {
        match request {
            Request::Load(config) => self.load(*config),
            Request::LoadSaved(path) => self.load_saved(&path),
            Request::Visit(at) => self.visit(at),
            Request::ForgetReleased => self.ensemble.forget_released(),
            Request::LeaveLessons => self.leave_lessons(),
            Request::SaveState => self.save_state(context),
            Request::SaveSession => self.save_session(context),
            Request::CopyLink => self.copy_link(context),
        }
    }

    /// True while a file or a recording is being written.
    pub fn is_writing(&self) -> bool {
        self.exports.is_writing()
    }

    /// Fetches the newest frame. What the controls show follows it, unless a change is on its way.
    pub(super) fn refresh(&mut self, context: &Context) {
        self.run.frame = self.run.live.latest().clone();
        self.follow_loads();
        let LiveFrame { acknowledged, start, .. } = &self.run.frame;
        if start.is_none() && *acknowledged == self.run.live.sent() {
            // The first load was cancelled or failed. The default scene needs no deposition.
            self.load(Config::default());
        }
        // The same words again are another refusal.
        let address = |refusal: &Option<Arc<str>>| refusal.as_ref().map(Arc::as_ptr);
        if address(&self.run.frame.refusal) != address(&self.seen_refusal) {
            self.seen_refusal.clone_from(&self.run.frame.refusal);
            if let Some(refusal) = self.seen_refusal.clone() {
                self.warn(refusal.to_string());
            }
        }
        self.run.follow_frame();
        if let Some(settings) = self.run.wanted_settings().filter(|_| !self.touring) {
            self.preferences.scene = self.run.config().with_settings(&settings);
        }
        self.panels.scene.follow(&self.run);
        if let Some(notice) = self.exports.follow(context) {
            self.notice = Some(notice);
        }
        self.ensemble.follow(context, &self.run.frame, self.preferences.ensemble);
    }

    /// Begins again with a start that was not there before.
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

    /// Says in the status bar for a while what went wrong.
    pub(crate) fn warn(&mut self, text: impl Into<String>) {
        self.notice = Some(Notice::new(text, true));
    }

    /// What the status bar has to say, and for how long yet, s.
    pub fn notice(&self) -> Option<(&Notice, f32)> {
        let notice = self.notice.as_ref()?;
        Some((notice, notice.left_secs()?))
    }

    fn set_pace(&mut self) {
        self.run.live.send(Command::SetPace(self.preferences.pace()));
    }

    /// Opens a scene.
    pub fn load(&mut self, config: Config) {
        self.open(Opening::Scene(Box::new(config)));
    }

    /// Opens a saved run, to go on with it.
    pub fn load_run(&mut self, state: SavedState) {
        self.open(Opening::Run(Box::new(state)));
    }

    /// Opens the file of a saved run or of a session, to go on with it.
    pub fn load_saved(&mut self, path: &Path) {
        self.exports.data.saved_run = path.display().to_string();
        self.open(Opening::File(path.to_owned()));
    }

    /// Has a start made where the run is computed. Other than for a lesson, lessons are left.
    pub(crate) fn open(&mut self, opening: Opening) {
        if !matches!(opening, Opening::Lesson(_)) {
            self.leave_lessons();
        }
        self.run.live.send(Command::Load(Box::new(opening)));
    }

    /// Goes to a lesson, or to the last one if there are not so many.
    pub fn visit(&mut self, at: usize) {
        let at = at.min(LESSONS.len() - 1);
        self.preferences.begin_lesson(at, LESSONS[at].choices());
        self.touring = true;
        self.panels.lesson_bar.loads_before = self.run.frame.loads;
        self.panels.lesson_bar.shows_summary = false;
        self.set_pace();
        self.open(Opening::Lesson(at));
    }

    /// Ends the lessons, with the worlds as they are.
    fn leave_lessons(&mut self) {
        if std::mem::take(&mut self.touring) {
            self.preferences.put_lesson_away();
            self.preferences.lesson.on = false;
            self.set_pace();
        }
    }

    /// Saves the moment that the selected world has come to.
    fn save_state(&mut self, context: &Context) {
        let run = self.run.take(self.run.selected);
        self.exports.write(context, &self.preferences.folder, vec![run], |folder, _, runs| {
            write_state(folder, runs.into_iter().next().ok_or_else(closed)?)
        });
    }

    /// Saves all worlds with their history, and how the window is arranged.
    pub(super) fn save_session(&mut self, context: &Context) {
        if self.run.frame.worlds.is_empty() {
            return;
        }
        let stored = StoredWindow::of(&self.preferences, context);
        let (touring, selected, camera) = (self.touring, self.run.selected, self.camera);
        let arrangement = Arrangement { stored, touring, selected, camera };
        let (sender, run) = channel();
        let hand_on = move |start: LiveStart| {
            // Whoever asked may have gone.
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

    /// Has the link of the present moment of all worlds copied.
    pub fn copy_link(&mut self, context: &Context) {
        self.exports.copy_link(context, self.run.take_all());
    }

    /// Arranges the window as it was when a session was saved. What belongs to this window and its user stays:
    /// its size, and where files go.
    fn arrange(&mut self, arrangement: Arrangement) {
        let Arrangement { stored, touring, selected, camera } = arrangement;
        let Preferences { window_points, folder, .. } = self.preferences.clone();
        self.preferences = Preferences { window_points, folder, ..stored.preferences };
        (self.touring, self.run.selected, self.camera) = (touring, selected, camera);
        self.layout = Some(stored.layout);
        self.set_pace();
    }

    /// Puts the panels where they were when a session was saved.
    pub(super) fn restore_layout(&mut self, context: &Context) {
        if let Some(layout) = self.layout.take() {
            context.memory_mut(|memory| memory.data = layout.data);
            context.set_zoom_factor(layout.options.zoom_factor);
        }
    }
}
