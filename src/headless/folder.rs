//! The folder that a run writes to, its own and of one run alone, and the checkpoint in it, from which the same command
//! goes on.
//!
//! A run is written by several things at once: rows of a table, pictures, states that wait for being drawn. Each tells a
//! checkpoint how far it has come, once all of that is on the disk, and comes back to it when the run goes on: what was
//! written later is cut off, and is written again just as it was. What is to be written besides has a mark of its own
//! in [`Marks`], which `RunWriter::marks` asks for and `RunWriter::open` hands back.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::manifest::{Instant, PictureEntry};
use crate::config::SavedState;
use crate::data::RecordingMark;
use crate::error::{Error, Result};
use crate::output::{
    FolderLock, Locked, check_recognised, check_writable, final_name, folder_of, is_recognised,
    remove_if_there, resolved,
};
use crate::scene::Scene;
use crate::sim::{ForceSums, Simulation, Tally};

/// What becomes of the files of an earlier run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum EarlierFiles {
    /// Where there are any, the folder is refused.
    Refused,
    Cleared,
    /// They stay: the run goes on with what it began.
    Kept,
}

/// A folder that no other run writes to.
pub(super) struct RunFolder {
    path: PathBuf,
    earlier: EarlierFiles,
    _lock: FolderLock,
}

impl RunFolder {
    /// Makes the folder where it is not there, and takes it for this run.
    ///
    /// # Errors
    /// Where it cannot be written to, another run has it, or it holds what is refused.
    pub(super) fn claim(path: &Path, earlier: EarlierFiles) -> Result<Self> {
        let folder = Self::lock(path, earlier)?;
        folder.check("")?;
        Ok(folder)
    }

    /// The same whatever it holds: that is to be looked at.
    ///
    /// # Errors
    /// Where it cannot be written to, or another run has it.
    pub(super) fn lock(path: &Path, earlier: EarlierFiles) -> Result<Self> {
        check_writable("frames", path)?;
        let lock = FolderLock::of(path, Locked::Pictures)?;
        Ok(Self { path: path.to_owned(), earlier, _lock: lock })
    }

    /// Its path.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// True if a run may go on with what it holds.
    pub(super) fn may_go_on(&self) -> bool {
        self.earlier == EarlierFiles::Refused
    }

    /// Refuses a folder that holds what is refused, or what is to be cleared and another program wrote; `why` says why no
    /// run goes on there.
    ///
    /// # Errors
    /// Names the first file.
    pub(super) fn check(&self, why: &str) -> Result<()> {
        let names = match self.earlier {
            EarlierFiles::Kept => return Ok(()),
            EarlierFiles::Refused | EarlierFiles::Cleared => files_of_a_run(&self.path, None)?,
        };
        if self.earlier == EarlierFiles::Cleared {
            let mut paths = names.iter().map(|name| self.path.join(name));
            return paths.try_for_each(|path| check_recognised(&path, "overwrite"));
        }
        let Some(name) = names.first() else { return Ok(()) };
        let allowed = format!(
            "a folder without an earlier run's files ({name} is there{why}), unless --overwrite is \
             given to remove them"
        );
        Err(Error::value("frames", self.path.display(), allowed))
    }

    /// Removes the pictures in it except those of the `marks` with which the run is resumed, and files that a kill has left
    /// half named, the `animation` among it where that is in the folder.
    ///
    /// # Errors
    /// Names a picture or a table that is not there as a whole, or a picture that cannot be removed.
    pub(super) fn keep(&self, marks: &Marks, animation: Option<&Path>) -> Result<()> {
        let pictures = &marks.pictures;
        let inside = animation.filter(|path| folder_of(path) == self.path);
        let inside = inside.and_then(|path| path.file_name()?.to_str());
        let is_kept = |name: &str| pictures.iter().any(|picture| picture.file == name);
        let names = files_of_a_run(&self.path, inside)?;
        if let Some(lost) = pictures.iter().find(|picture| !names.contains(&picture.file)) {
            let reason = "is missing, but must be where the checkpoint tells of it";
            return Err(Error::file(self.path.join(&lost.file), reason));
        }
        for (name, marked) in [(TABLE, marks.table), (WAITING, marks.waiting)] {
            let path = self.path.join(name);
            let found = path.metadata().map_or(0, |there| there.len());
            if found < marked {
                let reason =
                    format!("has {found} bytes, but must have all {marked} that were written");
                return Err(Error::file(path, reason));
            }
        }
        let goes = |name: &String| final_name(name) != name || (is_frame(name) && !is_kept(name));
        for name in names.iter().filter(|name| goes(name)) {
            let path = self.path.join(name);
            std::fs::remove_file(&path).map_err(|error| Error::file(&path, error))?;
        }
        Ok(())
    }

    /// Removes what is to be cleared. To be called when all that was asked is known to be sound.
    ///
    /// # Errors
    /// Names the file that cannot be removed.
    pub(super) fn clear(&self) -> Result<()> {
        if self.earlier != EarlierFiles::Cleared {
            return Ok(());
        }
        let mut names = files_of_a_run(&self.path, None)?;
        names.extend(told_of(&self.path));
        for path in names.iter().map(|name| self.path.join(name)).filter(|path| is_plain(path)) {
            // A list that anyone can edit may tell of anything.
            if is_recognised(&path)? {
                std::fs::remove_file(&path).map_err(|error| Error::file(&path, error))?;
            }
        }
        Ok(())
    }
}

/// The names that every run uses, and that of its `animation`, of those that are there.
fn files_of_a_run(folder: &Path, animation: Option<&str>) -> Result<Vec<String>> {
    let refuse = |error| Error::file(folder, error);
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(refuse)? {
        let name = entry.map_err(refuse)?.file_name();
        let name = name.to_string_lossy();
        let whole = final_name(&name);
        let is_ours = is_of_every_run(whole) || animation == Some(whole);
        if is_ours && is_plain(&folder.join(&*name)) {
            names.push(name.into_owned());
        }
    }
    names.sort();
    Ok(names)
}

fn is_of_every_run(name: &str) -> bool {
    is_frame(name) || ["manifest.json", TABLE, CHECKPOINT, WAITING].contains(&name)
}

/// Refuses places of one command, each with its option, that are one and the same, or that of a file which the run
/// writes in its folder.
///
/// # Errors
/// Names the option of the first.
pub(super) fn check_apart(places: &[(&str, &Path)], folder: Option<&Path>) -> Result<()> {
    let folder = folder.map(|folder| folder.canonicalize().unwrap_or_else(|_| folder.to_owned()));
    let mut taken: Vec<(&str, PathBuf)> = Vec::new();
    for &(option, path) in places {
        let Some(place) = resolved(path)? else { continue };
        let refuse = |allowed: &str| Err(Error::value(option, path.display(), allowed));
        if let Some((other, _)) = taken.iter().find(|(_, there)| *there == place) {
            return refuse(&format!("another path than that of {other}"));
        }
        let name = place.file_name().and_then(|name| name.to_str());
        if place.parent() == folder.as_deref() && name.is_some_and(is_of_every_run) {
            return refuse("a file that the run does not write itself in the folder of frames");
        }
        taken.push((option, place));
    }
    Ok(())
}

fn is_frame(name: &str) -> bool {
    let number = name.strip_prefix("frame_").and_then(|rest| rest.strip_suffix(".png"));
    number.is_some_and(|digits| digits.bytes().all(|byte| byte.is_ascii_digit()))
}

/// The pictures and tables that an earlier run's manifest tells of.
fn told_of(folder: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(folder.join("manifest.json")).unwrap_or_default();
    let manifest: serde_json::Value = serde_json::from_str(&text).unwrap_or_default();
    let list = |name: &str| manifest[name].as_array().cloned().unwrap_or_default();
    let pictures =
        list("pictures").into_iter().filter_map(|it| it["file"].as_str().map(str::to_owned));
    let tables = list("runs")
        .into_iter()
        .filter_map(|it| it["name"].as_str().map(|name| format!("{name}.csv")));
    // Whatever a file says: nothing outside of its folder is removed.
    let is_name = |name: &String| Path::new(name).file_name() == Some(name.as_ref());
    pictures.chain(tables).filter(is_name).collect()
}

/// A file, and neither a link to one nor a pipe: those are there to be written through.
fn is_plain(path: &Path) -> bool {
    path.symlink_metadata().is_ok_and(|there| there.is_file())
}

/// Name of the table of observables.
pub(super) const TABLE: &str = "observables.csv";
/// Name of a checkpoint.
pub(super) const CHECKPOINT: &str = "checkpoint.slump";
/// Name of the file in which states wait for being drawn, where they are to outlive the process.
pub(super) const WAITING: &str = "checkpoint.states";

/// How far everything had come that takes a run down.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Marks {
    /// Tells whether a command is the same.
    pub fingerprint: String,
    /// The number of the first picture that is not taken yet.
    pub next_picture: usize,
    /// Length of `observables.csv`, bytes.
    pub table: u64,
    /// Length of the states that wait for being drawn, bytes.
    pub waiting: u64,
    /// Pictures in the folder.
    pub pictures: Vec<PictureEntry>,
    /// The moment of the saved run that the command went on with, where it did.
    pub restarted_from: Option<Instant>,
    /// Moments at which the same command went on; none in one that has just begun.
    pub went_on_at: Vec<Instant>,
    /// What the recording has.
    pub recording: RecordingMark,
    /// What pairs have transmitted since the last of them.
    pub sums: ForceSums,
}

/// A run that is about to go on, from its start or from later.
pub(super) struct Beginning {
    pub state: SavedState,
    /// How far it had come in the folder that it writes to.
    pub marks: Marks,
}

/// Saves a run now and then, for the same command to go on with.
pub(super) struct Checkpoints {
    path: PathBuf,
    every_secs: f64,
    fingerprint: String,
    /// The number of the next one, in intervals since t = 0.
    next: f64,
}

impl Checkpoints {
    /// Those of a run in `folder` that begins at this moment.
    pub(super) fn start(
        folder: &Path,
        every_secs: f64,
        fingerprint: String,
        simulation: &Simulation,
    ) -> Self {
        let mut checkpoints =
            Self { path: folder.join(CHECKPOINT), every_secs, fingerprint, next: 0.0 };
        checkpoints.skip_to(simulation);
        checkpoints
    }

    fn skip_to(&mut self, simulation: &Simulation) {
        self.next = (simulation.time_secs() / self.every_secs).floor() + 1.0;
        // Rounding of sums of Δt must not make two of one.
        if self.is_due(simulation) {
            self.next += 1.0;
        }
    }

    pub(super) fn is_due(&self, simulation: &Simulation) -> bool {
        simulation.step_at(self.next * self.every_secs) <= simulation.observables().step
    }

    pub(super) fn write(
        &mut self,
        scene: &Scene,
        simulation: &Simulation,
        tally: &Tally,
        marks: Marks,
    ) -> Result<()> {
        let marks = Marks { fingerprint: self.fingerprint.clone(), ..marks };
        let mut state = SavedState::new(scene.clone(), simulation.clone(), *tally);
        state.of_run = rmp_serde::to_vec_named(&marks)
            .map_err(|error| Error::file(&self.path, format!("cannot be written ({error})")))?;
        state.save(&self.path)?;
        self.skip_to(simulation);
        Ok(())
    }

    /// Removes it: the run is complete, and nothing goes on from there.
    pub(super) fn remove(self) -> Result<()> {
        remove_if_there(&self.path)?;
        remove_if_there(&self.path.with_file_name(WAITING))
    }
}

/// The checkpoint of a command in its folder, if there is one.
///
/// # Errors
/// Why this command cannot go on with the one that is there.
pub(super) fn look(
    folder: &Path,
    fingerprint: &str,
) -> std::result::Result<Option<Beginning>, String> {
    let path = folder.join(CHECKPOINT);
    if !path.exists() {
        return Ok(None);
    }
    let mut state = SavedState::open(&path).map_err(|error| error.to_string())?;
    let marks: std::result::Result<Marks, _> = rmp_serde::from_slice(&state.of_run);
    match marks {
        Ok(mut marks) if marks.fingerprint == fingerprint => {
            state.of_run.clear();
            marks.went_on_at.push(Instant::of(state.simulation.observables()));
            Ok(Some(Beginning { state, marks }))
        }
        _ => Err("it is of another command".to_owned()),
    }
}
