//! Everything that the user interface reads and changes. Knows neither window nor GPU.

use std::collections::{BTreeMap, VecDeque};
use std::path::PathBuf;
use std::sync::{Arc, Mutex};

use egui::Rect;

use super::camera::SceneCamera;
use super::data_export::DataPanel;
use super::ensemble::Ensemble;
use super::export::Printers;
use super::file_names::is_saved_run;
use super::film::FilmFormat;
use super::notice::Notice;
use super::painting::LegendCache;
use super::panels::distributions::Distributions;
use super::panels::gallery::Gallery;
use super::panels::speed::StepRace;
use super::panels::table::BodyTable;
use super::panels::trust::RunBudget;
use super::panels::{Grabbing, GrainRef};
use super::preferences::Preferences;
use super::session::arrangement_of;
use super::work::Work;
use crate::config::Config;
use crate::live::{Command, Controls, Live, LiveFrame, WorldFrame};
use crate::sim::Settings;

/// The state of the user interface.
pub struct AppState {
    /// The solver's thread.
    pub live: Live,
    /// Its newest frame.
    pub frame: LiveFrame,
    /// What the controls show, one entry a world: ahead of the frame by what is on its way.
    pub(crate) wanted: Vec<Controls>,
    /// The world that the controls are about.
    pub(crate) selected: usize,
    /// What was loaded last.
    pub(crate) config: Config,
    pub(super) opening: OpeningState,
    /// What outlives the window.
    pub preferences: Preferences,
    /// Which part of the scene shows.
    pub camera: SceneCamera,
    /// What the mouse has chosen and holds.
    pub mouse: Grabbing,
    /// What a slider of the front is being dragged to, and in which world.
    pub(crate) draft: Option<(usize, Settings)>,
    /// True in a lesson.
    pub touring: bool,
    pub(crate) shown: Shown,
    pub(crate) exports: Exports,
    /// What the present settings make of other piles.
    pub ensemble: Ensemble,
    pub(crate) distributions: Distributions,
    pub(crate) race: Option<StepRace>,
    pub(crate) budget: Option<RunBudget>,
    /// Where controls lie, points: for tests that drive the window from outside.
    pub controls: BTreeMap<String, Rect>,
}

/// What is being opened.
#[derive(Default)]
pub(super) struct OpeningState {
    /// How the panels of a session that is being opened lay.
    pub layout: Option<egui::Memory>,
    seen_loads: u64,
    seen_refusal: Option<Arc<str>>,
}

/// What shows beside the run.
#[derive(Default)]
pub(crate) struct Shown {
    pub help: bool,
    /// True while the list behind "Can I trust this?" is open.
    pub trust: bool,
    /// Set where the window is to open its graphics device anew.
    pub restart_graphics: bool,
    pub(super) legend: LegendCache,
    pub(super) gallery: Gallery,
    /// How many starts there were before the present lesson's.
    pub(super) loads_before_lesson: u64,
    pub(super) table: BodyTable,
    notice: Option<Notice>,
}

/// What is being written. None of it keeps the window waiting.
#[derive(Default)]
pub(crate) struct Exports {
    /// Files that are written, one after another.
    pub files: VecDeque<Work<PathBuf>>,
    pub printers: Arc<Mutex<Printers>>,
    pub data: DataPanel,
    pub film: Option<(FilmFormat, Work<String>)>,
    /// A link that is to be copied, and whether something was changed by hand that it does not tell.
    pub link: Option<Work<(String, bool)>>,
}

impl Drop for Exports {
    fn drop(&mut self) {
        self.files.iter_mut().for_each(Work::end);
        self.film.iter_mut().for_each(|(_, work)| work.end());
        self.data.export.iter_mut().for_each(Work::end);
    }
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
            live,
            frame: LiveFrame::default(),
            wanted: Vec::new(),
            selected: 0,
            config: Config::default(),
            opening: OpeningState::default(),
            preferences,
            camera: SceneCamera::default(),
            mouse: Grabbing::default(),
            draft: None,
            touring: false,
            shown: Shown::default(),
            exports: Exports::default(),
            ensemble: Ensemble::new(),
            distributions: Distributions::default(),
            race: None,
            budget: None,
            controls: BTreeMap::new(),
        };
        // A window that was closed in a lesson and is opened for something else has the user's own choices.
        state.preferences.put_lesson_away();
        state.live.send(Command::SetPace(state.preferences.pace()));
        state
    }

    /// True while a file or a recording is being written.
    pub fn is_writing(&self) -> bool {
        let Exports { files, data, film, .. } = &self.exports;
        !files.is_empty() || data.export.is_some() || film.is_some()
    }

    /// Fetches the newest frame. What the controls show follows it, unless a change is on its way.
    pub(crate) fn refresh(&mut self) {
        self.frame = self.live.latest().clone();
        self.follow_loads();
        // The same words again are another refusal.
        let address = |refusal: &Option<Arc<str>>| refusal.as_ref().map(Arc::as_ptr);
        if address(&self.frame.refusal) != address(&self.opening.seen_refusal) {
            self.opening.seen_refusal.clone_from(&self.frame.refusal);
            if let Some(refusal) = self.frame.refusal.clone() {
                self.warn(refusal.to_string());
            }
        }
        let in_step = self.frame.acknowledged == self.live.sent() && !self.frame.seeking;
        if in_step || self.wanted.len() != self.frame.worlds.len() {
            self.wanted = self.frame.worlds.iter().map(|world| world.controls).collect();
        }
        if let Some((world, settings)) = self.draft
            && let Some(wanted) = self.wanted.get_mut(world)
        {
            wanted.settings = settings;
        }
        if let Some(wanted) = self.wanted.get(self.selected).filter(|_| !self.touring) {
            self.preferences.scene = self.config.clone().with_settings(&wanted.settings);
        }
        let worlds = self.frame.worlds.len();
        self.selected = self.selected.min(worlds.saturating_sub(1));
        let exists = |&GrainRef { world, grain }: &GrainRef| {
            let world = self.frame.worlds.get(world);
            world.is_some_and(|world| grain < world.snapshot.grains.len())
        };
        self.mouse.pinned = self.mouse.pinned.filter(exists);
        self.mouse.grabbed = self.mouse.grabbed.filter(exists);
        self.note_exports();
    }

    /// Begins anew with a start that was not there before.
    fn follow_loads(&mut self) {
        if self.frame.loads == self.opening.seen_loads {
            return;
        }
        self.opening.seen_loads = self.frame.loads;
        self.camera.frame_scene();
        self.mouse.pinned = None;
        self.exports.data.stretch = None;
        self.race = None;
        self.draft = None;
        if let Some(start) = self.frame.start.clone() {
            self.config.clone_from(&start.config);
            if let Some(arrangement) = arrangement_of(&start) {
                self.arrange(arrangement);
            }
        }
    }

    /// Says what became of exports that have ended.
    fn note_exports(&mut self) {
        if let Some(outcome) = self.exports.files.front().and_then(Work::outcome) {
            self.exports.files.pop_front();
            // A run that was just saved is the one that is likely to be opened.
            if let Some(path) = outcome.as_ref().ok().filter(|path| is_saved_run(path)) {
                self.exports.data.saved_run = path.display().to_string();
            }
            // Where the program was started is not where its user looks.
            let whole = |path: PathBuf| std::path::absolute(&path).unwrap_or(path);
            self.say(Notice::of(outcome.map(|path| format!("Saved {}", whole(path).display()))));
        }
        if let Some(outcome) = self.exports.film.as_ref().and_then(|(_, work)| work.outcome()) {
            self.exports.film = None;
            self.say(Notice::of(outcome));
        }
        if let Some(outcome) = self.exports.data.export.as_ref().and_then(Work::outcome) {
            self.exports.data.export = None;
            let notice = Notice::of(outcome);
            self.exports.data.told = Some(notice.clone());
            self.say(notice);
        }
    }

    /// The world that the controls are about, once there is one.
    pub fn world(&self) -> Option<&WorldFrame> {
        self.frame.worlds.get(self.selected)
    }

    /// True where what is open is a heap, of which slump tells.
    pub(crate) fn slumps(&self) -> bool {
        self.frame.start.as_ref().is_some_and(|start| start.slumps)
    }

    /// True while worlds are compared.
    pub(crate) fn compares(&self) -> bool {
        self.frame.worlds.len() > 1
    }

    /// Changes the settings of a world.
    pub fn change(&mut self, world: usize, settings: Settings) {
        if let Some(wanted) = self.wanted.get_mut(world) {
            wanted.settings = settings;
            self.live.send(Command::Change(world, settings));
        }
    }

    /// Says in the status bar for a while what went wrong.
    pub(crate) fn warn(&mut self, text: impl Into<String>) {
        self.say(Notice::new(text, true));
    }

    /// Says something in the status bar for a while.
    pub(super) fn say(&mut self, notice: Notice) {
        self.shown.notice = Some(notice);
    }

    /// What the status bar has to say, and for how long yet, s.
    pub fn notice(&self) -> Option<(&Notice, f32)> {
        let notice = self.shown.notice.as_ref()?;
        Some((notice, notice.left_secs()?))
    }

    /// Notes where a control lies.
    pub(crate) fn note_control(&mut self, name: &str, rect: Rect) {
        self.controls.insert(name.to_owned(), rect);
    }

    /// Releases, plays or pauses.
    pub(crate) fn toggle_play(&mut self) {
        let command = if self.frame.playing { Command::Pause } else { Command::Play };
        self.live.send(command);
    }

    /// Takes one step and pauses.
    pub fn step(&mut self) {
        self.live.send(Command::Step);
    }

    /// Goes one step back in the recording.
    pub(crate) fn step_back(&mut self) {
        let steps = self.frame.worlds.iter().map(|world| world.snapshot.observables.time_step_secs);
        let time_secs = self.frame.time_secs() - steps.fold(0.0, f64::max);
        self.live.send(Command::Seek(time_secs.max(0.0)));
    }
}
