//! Requests to open a scene, a lesson, a link or a saved run. The thread that computes the run converts such a request
//! to a [`LiveStart`], the initial state of a run.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::file_names::{is_saved_run, is_session};
use super::lessons::lesson;
use super::link::RunLink;
use super::scene_start::{start, start_of_run};
use super::session::open_session;
use super::settling_progress::SettlingProgress;
use crate::config::{Config, SavedState, SceneSource};
use crate::error::Result;
use crate::live::{LiveStart, RunHistory, StartSource, Tell, as_json, to_bytes};
use crate::scene::Scene;

/// Request to open an initial state. It is plain data, so that it can be sent to the thread or web worker that computes
/// the run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub enum Opening {
    /// Opens the scene that a configuration describes.
    Scene(#[serde(with = "as_json")] Box<Config>),
    /// Opens the lesson with this index. Its worlds (simulations) start side by side.
    Lesson(usize),
    /// Opens the run that the text of a link describes. Its simulations are computed up to their last steps. Settings
    /// that the user changed in the window are not used.
    Link(String),
    /// Opens a saved run, so that it can be continued.
    Run(Box<SavedState>),
    /// Opens a saved session: a run with its history and the arrangement of its window.
    Session(Box<LiveStart>),
    /// Opens the file of a saved run or of a session.
    File(PathBuf),
    /// Does what the request `opening` asks, with the content `bytes` of the file that `opening` names, because a web
    /// worker cannot read files.
    #[cfg(target_arch = "wasm32")]
    With {
        /// Name of the file that the user dropped on the page.
        path: PathBuf,
        /// Content of the file that the user dropped on the page.
        bytes: Vec<u8>,
        /// The request to open the file that the user dropped on the page.
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
                let lesson = lesson(at);
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

/// Returns the scene of a configuration. If the grains of a new pile must be deposited first, calls `tell` with the
/// progress and a picture of the grains.
fn settled(config: &Config, tell: Tell<'_>) -> Result<Scene> {
    let mut making = SettlingProgress::new();
    config.scene(|settling| tell(making.look(&settling)))
}

/// Returns the request to open a file, chosen by the ending of its name; `None` if the ending is unknown.
pub(super) fn opening_of(path: &Path) -> Option<Opening> {
    if is_saved_run(path) {
        return Some(Opening::File(path.to_owned()));
    }
    let config = match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
        "toml" => Config::of_scene(path.to_str()?),
        "csv" => {
            let source = SceneSource { initial: Some(path.to_owned()), ..SceneSource::default() };
            Config { source, ..Config::default() }
        }
        _ => return None,
    };
    Some(Opening::Scene(Box::new(config)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn endings_tell_scenes_from_discs_and_saved_runs() {
        let config = |path: &str| match opening_of(path.as_ref()) {
            Some(Opening::Scene(config)) => config.source,
            other => panic!("{path}: {other:?}"),
        };
        assert_eq!(config("a/Box.TOML").scene.as_deref(), Some("a/Box.TOML"));
        assert_eq!(config("a/pile.csv").initial.as_deref(), Some("a/pile.csv".as_ref()));
        assert!(is_saved_run("a/checkpoint.slump".as_ref()));
        assert!(!is_saved_run("a/pile.png".as_ref()));
        assert!(opening_of("a/pile.png".as_ref()).is_none());
    }
}
