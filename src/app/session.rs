//! A session: all worlds with their record, and the window as it was arranged, as one file.
//!
//! What is computed is kept as live runs keep it, thinned: the start, some moments on the way, every change
//! of the settings, and the moment that was shown. So it opens at once, and the moments between are computed
//! again, bit for bit, where the timeline asks for them.

use std::path::Path;
use std::sync::mpsc::{Receiver, Sender};

use serde::{Deserialize, Serialize};

use super::camera::SceneCamera;
use super::storage::Stored;
use super::taken::{LastOpened, Opened};
use crate::config::Config;
use crate::error::{Error, Result};
use crate::live::Start;
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
    pub stored: Stored,
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
    start: Start,
    scene: Scene,
    /// What opens the scene again, as JSON.
    config: String,
    /// The [`Arrangement`], as RON.
    window: String,
}

/// A session that is on its way to a file.
pub(crate) struct SessionOrder {
    /// What the solver's thread hands out.
    pub run: Receiver<(Start, Opened)>,
    /// The [`Arrangement`], as RON.
    pub window: String,
}

impl Session {
    /// Reads a file.
    ///
    /// # Errors
    /// Where it cannot be read, is damaged or of another version, or is no such file.
    pub(crate) fn open(path: &Path) -> Result<Self> {
        let session: Self = SEAL.open(path)?;
        let is_sound = session.start.record.as_ref().is_some_and(|record| record.is_sound());
        if is_sound && session.parts().is_some() {
            return Ok(session);
        }
        Err(Error::file(path, format!("holds no whole session, but must be {}", SEAL.form)))
    }

    /// What is text in it.
    fn parts(&self) -> Option<(Config, Arrangement)> {
        Some((serde_json::from_str(&self.config).ok()?, ron::from_str(&self.window).ok()?))
    }

    /// Takes it apart: the start, and what goes to the window.
    pub(super) fn begin(self, last: &LastOpened, window: &Sender<Arrangement>) -> Start {
        if let Some((config, arrangement)) = self.parts() {
            last.note(Opened { scene: self.scene, config });
            // Whoever waits for it has gone where another file is opened already.
            let _ = window.send(arrangement);
        }
        self.start
    }
}

impl SessionOrder {
    /// Waits for the run, and gives what is in the file.
    ///
    /// # Errors
    /// Where there is no run, or one that cannot go on.
    fn bytes(&self) -> Result<Vec<u8>> {
        let run = self.run.recv();
        let (start, Opened { scene, config }) =
            run.map_err(|_| Error::value("run", "closed", "open when its session is saved"))?;
        if start.record.as_ref().is_some_and(|record| record.failure().is_some()) {
            let allowed = "an earlier one: drag the timeline back";
            return Err(Error::value("state", "no longer finite", allowed));
        }
        let refuse = |error| Error::value("scene", &scene.name, format!("written ({error})"));
        let config = serde_json::to_string(&config).map_err(refuse)?;
        SEAL.written(&Session { start, scene, config, window: self.window.clone() })
    }
}

/// Writes a session.
///
/// # Errors
/// Names the file and what the system says, or why the run cannot be saved.
pub(super) fn write_session(path: &Path, order: &SessionOrder) -> Result<()> {
    write_file(path, &order.bytes()?)
}
