//! Opening: from what a user asks for to a start, which is made where the run is computed.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};

use egui::Context;
use serde::{Deserialize, Serialize};

use super::IN_BROWSER;
use super::file_names::{is_saved_run, is_session, refused_file};
use super::lessons::LESSONS;
use super::scene_start::{start, start_of_run};
use super::session::open_session;
use super::settling_progress::SettlingProgress;
use super::sharing::RunLink;
use super::state::AppState;
use crate::config::{Config, SavedState, SceneSource};
use crate::error::Result;
use crate::live::{
    Command, LiveStart, RunHistory, StartSource, Tell, WorldHistory, as_json, to_bytes,
};
use crate::scene::Scene;

/// What a start is made from. It is data, so that it can be sent to where the run is computed.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub enum Opening {
    /// A scene.
    Scene(#[serde(with = "as_json")] Box<Config>),
    /// A lesson by its place, with its worlds side by side.
    Lesson(usize),
    /// What a link tells of, with what its worlds have come to. Settings are those that it says, whatever the window
    /// would choose.
    Link(String),
    /// A saved run, to go on with it.
    Run(Box<SavedState>),
    /// A session, with its window as it was arranged.
    Session(Box<LiveStart>),
    /// The file of one of these two.
    File(PathBuf),
    /// One of these, with the file that it names.
    #[cfg(target_arch = "wasm32")]
    With {
        /// Its name.
        path: PathBuf,
        /// All that is in it.
        bytes: Vec<u8>,
        /// What names it.
        opening: Box<Opening>,
    },
}

impl StartSource for Opening {
    fn make(self: Box<Self>, tell: Tell<'_>) -> Result<LiveStart> {
        match *self {
            Self::Scene(config) => {
                let scene = settled(&config, tell)?;
                start(&scene, *config)
            }
            Self::Lesson(at) => {
                let lesson = &LESSONS[at.min(LESSONS.len() - 1)];
                let (config, scene) = lesson.scene()?;
                let worlds = (lesson.worlds)(scene.settings());
                let start = start(&scene, config)?;
                let zoomed = lesson.view.map(|view| view.map(|end| scene.mean_diameter * end));
                Ok(LiveStart { worlds, view: zoomed.unwrap_or(start.view), ..start })
            }
            Self::Link(text) => {
                let link = RunLink::read(&text)?;
                let config = link.config();
                let scene = settled(&config, tell)?;
                let start = start(&scene, config)?;
                let plans = link.plans(&scene.settings());
                let history = RunHistory::computed(&start.simulation, start.tally, &plans, tell)?;
                Ok(LiveStart { history: Some(history), ..start })
            }
            Self::Run(state) => Ok(start_of_run(*state)),
            Self::Session(start) => Ok(*start),
            Self::File(path) if is_session(&path) => open_session(&path),
            Self::File(path) => Ok(start_of_run(SavedState::open(&path)?)),
            #[cfg(target_arch = "wasm32")]
            Self::With { path, bytes, opening } => {
                crate::output::give_file(path, bytes);
                opening.make(tell)
            }
        }
    }

    fn to_bytes(&self) -> Result<Vec<u8>> {
        to_bytes(self)
    }
}

/// A run that is to be written down.
pub(crate) struct TakenRun {
    pub start: Arc<LiveStart>,
    pub world: WorldHistory,
}

impl AppState {
    /// Opens a scene.
    pub fn load(&mut self, config: Config) {
        self.config = config.clone();
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
        self.live.send(Command::Load(Box::new(opening)));
    }

    /// Asks for a world's run. It comes between two steps; nothing comes where that world is gone.
    pub(crate) fn take_run(&mut self, world: usize) -> Receiver<TakenRun> {
        let (sender, receiver) = channel();
        let hand_on = move |start, world| {
            // Whoever asked may have gone.
            let _ = sender.send(TakenRun { start, world });
        };
        self.live.send(Command::Take(world, Box::new(hand_on)));
        receiver
    }
}

/// The scene, shown and with progress told where a new pile has to settle first.
fn settled(config: &Config, tell: Tell<'_>) -> Result<Scene> {
    let mut making = SettlingProgress::new();
    config.scene(|settling| tell(making.look(&settling)))
}

/// Opens the last file that was dropped in this frame. A page has to wait for its content.
pub(super) fn take_dropped_files(context: &Context, state: &mut AppState) {
    let dropped = context.input(|input| input.raw.dropped_files.last().cloned());
    let Some(file) = dropped.filter(|_| !IN_BROWSER) else { return };
    let path = file.path();
    match opening_of(path) {
        Some(Opening::File(path)) => state.load_saved(&path),
        Some(opening) => state.open(opening),
        None => state.warn(refused_file(path)),
    }
}

/// What opens a file, by its name.
pub(super) fn opening_of(path: &Path) -> Option<Opening> {
    if is_saved_run(path) {
        return Some(Opening::File(path.to_owned()));
    }
    Some(Opening::Scene(Box::new(dropped_scene(path)?)))
}

/// What opens a file that is a scene or a list of discs by its name.
fn dropped_scene(path: &Path) -> Option<Config> {
    match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
        "toml" => path.to_str().map(Config::of_scene),
        "csv" => {
            let source = SceneSource { initial: Some(path.to_owned()), ..SceneSource::default() };
            Some(Config { source, ..Config::default() })
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn endings_tell_scenes_from_discs_and_saved_runs() {
        let config = |path: &str| dropped_scene(path.as_ref()).expect(path).source;
        assert_eq!(config("a/Box.TOML").scene.as_deref(), Some("a/Box.TOML"));
        assert_eq!(config("a/pile.csv").initial.as_deref(), Some("a/pile.csv".as_ref()));
        assert!(is_saved_run("a/checkpoint.slump".as_ref()));
        assert!(!is_saved_run("a/pile.png".as_ref()));
        assert_eq!(dropped_scene("a/pile.png".as_ref()), None);
    }
}
