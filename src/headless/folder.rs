//! The output folder of one run, and its checkpoint file, with which the same command can resume a run that was
//! stopped.
//!
//! Several writers fill the folder: the table of observables (measured quantities of each step), the pictures, and the
//! file of snapshots that are drawn at the end of the run. At a checkpoint each writer first flushes its data to the
//! disk and then reports the length of its output, its *mark*. When the run resumes, each output is cut off at its
//! mark, and the rest is written again with the same contents. A new kind of output needs a mark in [`Marks`], which
//! `RunWriter::marks` collects and `RunWriter::open` passes to the writers.

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

/// Treatment of files that an earlier run left in the output folder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum EarlierFiles {
    /// The new run ends with an error if the folder contains files of an earlier run.
    Refused,
    Cleared,
    /// The files are kept and do not cause an error: `slump reproduce` draws into the folder of its other figures.
    Kept,
}

/// An output folder, locked so that no other run uses it at the same time.
pub(super) struct RunFolder {
    path: PathBuf,
    earlier: EarlierFiles,
    _lock: FolderLock,
}

impl RunFolder {
    /// Creates the folder if it is missing, locks it for this run, and checks its contents.
    ///
    /// # Errors
    /// If the folder cannot be written to, if another run uses it, or if it contains files of an earlier run that
    /// `earlier` does not allow ([`Self::check`]).
    pub(super) fn claim(path: &Path, earlier: EarlierFiles) -> Result<Self> {
        let folder = Self::lock(path, earlier)?;
        folder.check("")?;
        Ok(folder)
    }

    /// Creates the folder if it is missing, and locks it for this run, without a check of its contents.
    ///
    /// # Errors
    /// If the folder cannot be written to, or another run uses it.
    pub(super) fn lock(path: &Path, earlier: EarlierFiles) -> Result<Self> {
        check_writable("frames", path)?;
        let lock = FolderLock::of(path, Locked::Pictures)?;
        Ok(Self { path: path.to_owned(), earlier, _lock: lock })
    }

    /// Path of the folder.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// True if the run of an earlier call may be resumed from the files in the folder. False if the user asked to
    /// remove these files, or if they are kept without being read ([`EarlierFiles::Kept`]).
    pub(super) fn may_go_on(&self) -> bool {
        self.earlier == EarlierFiles::Refused
    }

    /// Checks the files in the folder that have the names of a run's files. With [`EarlierFiles::Refused`] every such
    /// file is an error; the message contains `why`, the reason why no run can be resumed from the folder. With
    /// [`EarlierFiles::Cleared`] such a file is an error only if another program wrote it, because the run is going to
    /// remove it. With [`EarlierFiles::Kept`] nothing is checked.
    ///
    /// # Errors
    /// The message names the first file that is an error.
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

    /// Prepares the folder for a run that is resumed from a checkpoint, whose data about the outputs are `marks`.
    /// Removes the pictures that `marks` does not list, because they are later than the checkpoint. Also removes
    /// unfinished files of a process that was killed, including an unfinished `animation` (GIF or video) in the folder.
    ///
    /// # Errors
    /// Names a picture or table that is missing or incomplete, or a picture that cannot be removed.
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

    /// Removes the files of an earlier run, if the folder was opened with [`EarlierFiles::Cleared`]. Call this function
    /// after all other checks, because the files cannot be restored.
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
            // Users can edit the manifest, so each file that it lists is checked before it is removed.
            if is_recognised(&path)? {
                std::fs::remove_file(&path).map_err(|error| Error::file(&path, error))?;
            }
        }
        Ok(())
    }
}

/// Returns the names of those files in `folder` that a run writes: pictures of frames, table, manifest and checkpoint
/// files, and the file named `animation`. Their unfinished versions are included.
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

/// Returns an error if two options name the same path, or if an option names a file that the run itself writes into its
/// folder.
///
/// # Errors
/// Names the first such option.
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

/// Returns the names of the pictures and tables in the manifest of an earlier run.
fn told_of(folder: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(folder.join("manifest.json")).unwrap_or_default();
    let manifest: serde_json::Value = serde_json::from_str(&text).unwrap_or_default();
    let list = |name: &str| manifest[name].as_array().cloned().unwrap_or_default();
    let pictures =
        list("pictures").into_iter().filter_map(|it| it["file"].as_str().map(str::to_owned));
    let tables = list("runs")
        .into_iter()
        .filter_map(|it| it["name"].as_str().map(|name| format!("{name}.csv")));
    // Files outside the folder are never removed, even if the manifest lists them.
    let is_name = |name: &String| Path::new(name).file_name() == Some(name.as_ref());
    pictures.chain(tables).filter(is_name).collect()
}

/// True for a regular file. False for links, pipes and devices, which are never removed: the run writes into them, or
/// into the file to which a link leads.
fn is_plain(path: &Path) -> bool {
    path.symlink_metadata().is_ok_and(|there| there.is_file())
}

/// Name of the file in the output folder with the table of observables (measured quantities of each step).
pub(super) const TABLE: &str = "observables.csv";
/// Name of the checkpoint file in the output folder.
pub(super) const CHECKPOINT: &str = "checkpoint.slump";
/// Name of the file of snapshots that are drawn at the end of the run. It exists only if the snapshots must survive the
/// end of the process.
pub(super) const WAITING: &str = "checkpoint.states";

/// Lengths of all outputs of a run at a checkpoint, and other data with which the run is resumed. A resumed run cuts
/// the outputs off at these lengths.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Marks {
    /// Hash of the command and its inputs; only the same command can resume the run.
    pub fingerprint: String,
    /// Number of the next picture to be drawn.
    pub next_picture: usize,
    /// Length of `observables.csv`, bytes.
    pub table: u64,
    /// Length of the file of snapshots that are drawn at the end of the run, bytes.
    pub waiting: u64,
    /// Pictures that the run has written into the folder.
    pub pictures: Vec<PictureEntry>,
    /// Step number and simulated time of the saved run with which the command started (`--restart`); `None` without
    /// this option.
    pub restarted_from: Option<Instant>,
    /// Step numbers and simulated times at which the same command resumed the run; empty in a run without interruption.
    pub went_on_at: Vec<Instant>,
    /// Extent of the recording of grains and contacts: its numbers of frames (recorded states) and of rows in its
    /// tables.
    pub recording: RecordingMark,
    /// Sums of contact forces, per pair of bodies, over the steps since the last frame of the recording (the last state
    /// that was written to its files of grains and contacts).
    pub sums: ForceSums,
}

/// State of the simulation and of the outputs with which a run starts or resumes.
pub(super) struct Beginning {
    pub state: SavedState,
    /// Lengths of the outputs at the last checkpoint, for a resumed run. When the run opens an output, it cuts the
    /// output off at this length, because it writes everything after the checkpoint again. All lengths are 0 in a new
    /// run.
    pub marks: Marks,
}

/// Writer of checkpoints: saves a run at intervals of simulated time, so that the same command can resume it.
pub(super) struct Checkpoints {
    path: PathBuf,
    every_secs: f64,
    fingerprint: String,
    /// Number of the next checkpoint. Checkpoint n is due at the simulated time n · `every_secs`.
    next: f64,
}

impl Checkpoints {
    /// Returns the writer of the checkpoints in `folder` for a run that begins at the present state of `simulation`.
    /// `every_secs` is the interval of simulated time, s.
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
        // The time is a sum of time steps, and its rounding must not cause a second checkpoint at the same time.
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

    /// Removes the checkpoint files of a complete run.
    pub(super) fn remove(self) -> Result<()> {
        remove_if_there(&self.path)?;
        remove_if_there(&self.path.with_file_name(WAITING))
    }
}

/// Returns the checkpoint in the folder that the same command wrote, or `None` if the folder has no checkpoint.
///
/// # Errors
/// States why this command cannot resume the run from the checkpoint.
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
