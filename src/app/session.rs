//! A session: all worlds with their history, and the window as it was arranged, as one file; and the file of a saved run.
//!
//! What is computed is kept as live runs keep it, thinned: the start, some moments on the way, every change
//! of the settings, and the moment that was shown. So it opens at once, and the moments between are computed
//! again, bit for bit, where the timeline asks for them.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::camera::SceneCamera;
use super::file_names::{SESSION_ENDING, STATE_ENDING, free_path, stem};
use super::preferences::StoredWindow;
use super::watched_run::TakenRun;
use crate::config::SavedState;
use crate::error::{Error, Result};
use crate::live::LiveStart;
use crate::output::{Seal, write_file};

/// What files begin with.
const SEAL: Seal = Seal {
    magic: "slump-session ",
    format: 8,
    what: "session",
    of: "",
    form: "a session that the window saved",
};

/// How a window is arranged.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Arrangement {
    pub stored: StoredWindow,
    pub touring: bool,
    pub selected: usize,
    pub camera: SceneCamera,
}

/// Reads a file: the start, with how the window was arranged.
pub(super) fn open_session(path: &Path) -> Result<LiveStart> {
    let start: LiveStart = SEAL.open(path)?;
    let is_sound = start.history.as_ref().is_some_and(|history| history.is_sound());
    if !is_sound || arrangement_of(&start).is_none() {
        let reason = format!("holds no whole session, but must be {}", SEAL.form);
        return Err(Error::file(path, reason));
    }
    Ok(start)
}

/// How the window is to be arranged; nothing where the start is of no session.
pub(super) fn arrangement_of(start: &LiveStart) -> Option<Arrangement> {
    ron::from_str(start.window.as_ref()?).ok()
}

/// Writes a session into a folder: the start with all that it has come to, and how the window is arranged.
pub(super) fn write_session(
    folder: &Path,
    stem: &str,
    start: LiveStart,
    arrangement: &Arrangement,
) -> Result<PathBuf> {
    if start.history.as_ref().is_some_and(|history| history.failure().is_some()) {
        return Err(not_finite());
    }
    let path = free_path(folder, stem, SESSION_ENDING);
    let refuse = |error| Error::value("window", "arranged so", format!("written ({error})"));
    let window = Some(ron::to_string(arrangement).map_err(refuse)?);
    write_file(&path, &SEAL.written(&LiveStart { window, ..start })?)?;
    Ok(path)
}

/// Writes the moment that a run had when it was handed out: it may go on meanwhile.
pub(super) fn write_state(folder: &Path, run: TakenRun) -> Result<PathBuf> {
    let TakenRun { start, world } = run;
    if world.failure.is_some() {
        return Err(not_finite());
    }
    let settings = [*world.simulation.settings()];
    let stem = stem(&start.scene.name, &settings, world.simulation.time_secs());
    let path = free_path(folder, &stem, STATE_ENDING);
    SavedState::new(start.scene.clone(), world.simulation, world.tally).save(&path)?;
    Ok(path)
}

/// Why a run that has failed is not saved.
fn not_finite() -> Error {
    Error::value("state", "no longer finite", "an earlier one: drag the timeline back")
}
