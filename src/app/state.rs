//! Everything that the user interface reads and changes. Knows neither window nor GPU.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::mpsc::Receiver;
use std::time::Instant;

use egui::Rect;

use super::camera::SceneCamera;
use super::data_export::DataPanel;
use super::ensemble::Ensemble;
use super::export::{Exporter, STATE_ENDING};
use super::film::FilmFormat;
use super::opening::LastOpened;
use super::painting::LegendCache;
use super::panels::distributions::Distributions;
use super::panels::speed::StepRace;
use super::panels::{Grabbing, GrainRef};
use super::preferences::Preferences;
use super::session::{Arrangement, SESSION_ENDING};
use super::sharing::PendingLink;
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
    /// What is being opened, and what was.
    pub(super) opening: OpeningState,
    /// What outlives the window.
    pub preferences: Preferences,
    /// Which part of the scene shows.
    pub camera: SceneCamera,
    /// What the mouse has chosen and holds.
    pub mouse: Grabbing,
    /// Whether the tour is being taken.
    pub touring: bool,
    /// What shows beside the run.
    pub(crate) shown: Shown,
    /// What is being written.
    pub(crate) exports: Exports,
    /// What the present settings make of other piles.
    pub ensemble: Ensemble,
    /// How forces and the like are distributed.
    pub(crate) distributions: Distributions,
    /// How methods solve the step that was shown.
    pub(crate) race: Option<StepRace>,
    /// Where controls lie, points: for tests that drive the window from outside.
    pub controls: BTreeMap<String, Rect>,
}

/// What is being opened, and what was.
#[derive(Default)]
pub(super) struct OpeningState {
    /// What was opened last.
    pub last: LastOpened,
    /// The window of a session that is being opened, …
    pub arriving: Option<Receiver<Arrangement>>,
    /// … and how its panels lay.
    pub layout: Option<egui::Memory>,
    seen_loads: u64,
    seen_refusal: Option<Arc<str>>,
}

/// What shows beside the run.
#[derive(Default)]
pub(crate) struct Shown {
    /// The panel that is to be opened, where a station asks for one.
    pub panel: Option<&'static str>,
    /// Whether the help overlay shows.
    pub help: bool,
    /// Set where the window is to open its graphics device anew.
    pub restart_graphics: bool,
    pub(super) legend: LegendCache,
    notice: Option<Notice>,
}

/// What is being written. None of it keeps the window waiting.
#[derive(Default)]
pub(crate) struct Exports {
    /// Writes files one after another.
    pub files: Exporter,
    /// What is being done about data and saved runs.
    pub data: DataPanel,
    /// The video or the animation that is being made.
    pub film: Option<(FilmFormat, Work)>,
    /// A link that is to be copied.
    pub(super) link: Option<PendingLink>,
}

impl AppState {
    /// The state at the start of the program; loading `config` begins.
    pub fn new(live: Live, config: Config, preferences: Preferences) -> Self {
        let mut state = Self::idle(live, preferences);
        state.load(config);
        state
    }

    /// The same, with nothing that is loaded.
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
            touring: false,
            shown: Shown::default(),
            exports: Exports::default(),
            ensemble: Ensemble::new(),
            distributions: Distributions::default(),
            race: None,
            controls: BTreeMap::new(),
        };
        // A window that was closed on the tour and is opened for something else has the user's own choices.
        state.preferences.put_tour_away();
        state.live.send(Command::SetPace(state.preferences.pace()));
        state
    }

    /// Whether a file or a recording is being written.
    pub fn is_writing(&self) -> bool {
        let Exports { files, data, film, .. } = &self.exports;
        files.is_busy() || data.export.is_some() || film.is_some()
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
        if let Some(wanted) = self.wanted.get(self.selected).filter(|_| !self.touring) {
            self.preferences.scene = self.config.clone().with_settings(&wanted.settings);
        }
        let worlds = self.frame.worlds.len();
        self.selected = self.selected.min(worlds.saturating_sub(1));
        self.mouse.pinned = self.mouse.pinned.filter(|pinned| self.exists(*pinned));
        self.mouse.grabbed = self.mouse.grabbed.filter(|grabbed| self.exists(*grabbed));
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
        if let Some(opened) = self.opening.last.get() {
            self.config.clone_from(&opened.config);
        }
        let arriving = self.opening.arriving.as_ref();
        if let Some(arrangement) = arriving.and_then(|window| window.try_recv().ok()) {
            self.arrange(arrangement);
        }
    }

    fn note_exports(&mut self) {
        match self.exports.files.take_outcome() {
            Some(Ok(path)) => {
                // Where the program was started is not where its user looks.
                let whole = std::path::absolute(&path).unwrap_or_else(|_| path.clone());
                self.tell(format!("Saved {}", whole.display()));
                // A run that was just saved is the one that is likely to be opened.
                let is = |ending: &str| path.extension().is_some_and(|found| found == ending);
                if is(STATE_ENDING) || is(SESSION_ENDING) {
                    self.exports.data.saved_run = path.display().to_string();
                }
            }
            Some(Err(error)) => self.warn(error.to_string()),
            None => {}
        }
        let film = self.exports.film.as_ref().and_then(|(_, work)| work.take_outcome());
        if let Some((text, failure)) = film {
            self.exports.film = None;
            self.say(text, failure);
        }
        let data = self.exports.data.export.as_ref().and_then(Work::take_outcome);
        if let Some((text, failure)) = data {
            self.exports.data.export = None;
            self.exports.data.told = Some((text.clone(), failure));
            self.say(text, failure);
        }
    }

    fn exists(&self, grain: GrainRef) -> bool {
        let world = self.frame.worlds.get(grain.world);
        world.is_some_and(|world| grain.grain < world.snapshot.grains.len())
    }

    /// The world that the controls are about, once there is one.
    pub fn world(&self) -> Option<&WorldFrame> {
        self.frame.worlds.get(self.selected)
    }

    /// Whether what is open is a heap, of which slump tells.
    pub(crate) fn slumps(&self) -> bool {
        self.frame.start.as_ref().is_some_and(|start| start.slumps)
    }

    /// Whether worlds are compared.
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

    /// Says something in the status bar for a while.
    pub(crate) fn warn(&mut self, text: impl Into<String>) {
        self.say(text.into(), true);
    }

    /// The same of what went well.
    pub(crate) fn tell(&mut self, text: impl Into<String>) {
        self.say(text.into(), false);
    }

    fn say(&mut self, text: String, failure: bool) {
        self.shown.notice = Some(Notice::new(text, failure));
    }

    /// What the status bar has to say, and for how long yet, s.
    pub fn notice(&self) -> Option<(&Notice, f32)> {
        let notice = self.shown.notice.as_ref()?;
        Some((notice, notice.left_secs()?))
    }

    /// Forgets what lives in an egui context: it is about to be replaced.
    pub(crate) fn forget_context(&mut self) {
        self.shown.legend.forget();
        self.ensemble.stop();
    }

    /// Notes where a control lies.
    pub(crate) fn note_control(&mut self, name: &str, rect: Rect) {
        match self.controls.get_mut(name) {
            Some(place) => *place = rect,
            None => {
                self.controls.insert(name.to_owned(), rect);
            }
        }
    }
}

impl AppState {
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

    /// Back to the start, with the present settings.
    pub(crate) fn reset(&mut self) {
        self.live.send(Command::Reset);
    }

    /// Back to the run that the present one has taken the place of last.
    pub(crate) fn undo(&mut self) {
        if let Some(last) = self.frame.past.last() {
            self.live.send(Command::Return(last.number));
        }
    }
}

/// How long a notice stays, s.
const NOTICE_SECS: f32 = 8.0;

/// A sentence for the status bar.
#[derive(Clone, Debug)]
pub struct Notice {
    /// The sentence.
    pub text: String,
    /// Whether it tells of a failure.
    pub(crate) failure: bool,
    since: Instant,
}

impl Notice {
    /// One that begins now.
    pub(super) fn new(text: String, failure: bool) -> Self {
        Self { text, failure, since: Instant::now() }
    }

    /// For how long it stays yet, s.
    pub(super) fn left_secs(&self) -> Option<f32> {
        let left = NOTICE_SECS - self.since.elapsed().as_secs_f32();
        (left > 0.0).then_some(left)
    }
}
