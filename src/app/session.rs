//! Files of sessions (all simulations with their history and the arrangement of the window) and of saved runs.
//!
//! A session stores runs as the program stores them in memory: the initial state, some later states (keyframes), all
//! changes of settings, and the displayed state. It therefore opens without computing. States between the keyframes are
//! computed again, with the same bits, when the user moves to them on the timeline.

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

/// First bytes of a session file, by which the program recognises such a file.
const SEAL: Seal = Seal {
    magic: "slump-session ",
    format: 10,
    what: "session",
    of: "",
    form: "a session that the window saved",
};

/// Arrangement of the window: the preferences, the layout of panels, the selected simulation, and the visible area.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Arrangement {
    pub stored: StoredWindow,
    pub touring: bool,
    pub selected: usize,
    pub camera: SceneCamera,
}

/// Reads a session from a file: the runs and the arrangement of the window.
pub(super) fn open_session(path: &Path) -> Result<LiveStart> {
    let start: LiveStart = SEAL.open(path)?;
    let is_sound = start.history.as_ref().is_some_and(|history| history.is_sound());
    if !is_sound || arrangement_of(&start).is_none() {
        let reason = format!("holds no complete session, but must be {}", SEAL.form);
        return Err(Error::file(path, reason));
    }
    Ok(start)
}

/// Returns the arrangement of the window that a session contains; `None` if `start` is not from a session.
pub(super) fn arrangement_of(start: &LiveStart) -> Option<Arrangement> {
    ron::from_str(start.window.as_ref()?).ok()
}

/// Writes a session into a folder.
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
    let refuse = |error| {
        Error::value("window", "arranged like this", format!("one that can be written ({error})"))
    };
    let window = Some(ron::to_string(arrangement).map_err(refuse)?);
    write_file(&path, &SEAL.written(&LiveStart { window, ..start })?)?;
    Ok(path)
}

/// Saves a copied run to a file: the state that the run had when it was copied from the solver's thread. The run itself
/// may continue meanwhile.
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

/// Returns the error for saving a run whose state contains infinite values or NaN.
fn not_finite() -> Error {
    Error::value("state", "no longer finite", "an earlier one: drag the timeline back")
}
