//! The folder that a run writes to, and the checkpoint in it.

use std::path::{Path, PathBuf};

use crate::config::SavedState;
use crate::error::{Error, Result};
use crate::output::{check_writable, final_name, remove_if_there};
use crate::scene::Scene;
use crate::sim::{Simulation, Tally};

/// What becomes of the files of an earlier run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum EarlierFiles {
    /// Where there are any, the folder is refused.
    Refused,
    Cleared,
    /// They stay: the run goes on with what it began.
    Kept,
}

/// Makes the folder of a run where it is not there.
///
/// Fails where it cannot be written to, or holds what is refused: names the first file.
pub(super) fn check_run_folder(path: &Path, earlier: EarlierFiles) -> Result<()> {
    check_writable("frames", path)?;
    if earlier == EarlierFiles::Refused
        && let Some(name) = files_of_a_run(path)?.first()
    {
        let allowed = format!(
            "a folder without an earlier run's files ({name} is there), unless --overwrite is given to \
             remove them"
        );
        return Err(Error::value("frames", path.display(), allowed));
    }
    Ok(())
}

/// Removes what is to be cleared. To be called when all that was asked is known to be sound.
pub(super) fn clear_run_folder(path: &Path, earlier: EarlierFiles) -> Result<()> {
    if earlier != EarlierFiles::Cleared {
        return Ok(());
    }
    let mut names = files_of_a_run(path)?;
    names.extend(told_of(path));
    for path in names.iter().map(|name| path.join(name)).filter(|path| is_plain(path)) {
        std::fs::remove_file(&path).map_err(|error| Error::file(&path, error))?;
    }
    Ok(())
}

/// The names that every run uses, of those that are there.
fn files_of_a_run(folder: &Path) -> Result<Vec<String>> {
    let refuse = |error| Error::file(folder, error);
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(refuse)? {
        let name = entry.map_err(refuse)?.file_name();
        let name = name.to_string_lossy();
        let whole = final_name(&name);
        let is_ours =
            is_frame(whole) || ["manifest.json", "observables.csv", CHECKPOINT].contains(&whole);
        if is_ours && is_plain(&folder.join(&*name)) {
            names.push(name.into_owned());
        }
    }
    names.sort();
    Ok(names)
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

const CHECKPOINT: &str = "checkpoint.slump";

/// Saves a run now and then, for another to go on with.
pub(super) struct Checkpoints {
    path: PathBuf,
    every_secs: f64,
    /// The number of the next one, in intervals since t = 0.
    next: f64,
}

impl Checkpoints {
    /// Those of a run in `folder` that begins at this moment.
    pub(super) fn start(folder: &Path, every_secs: f64, simulation: &Simulation) -> Self {
        let mut checkpoints = Self { path: folder.join(CHECKPOINT), every_secs, next: 0.0 };
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
    ) -> Result<()> {
        SavedState::new(scene.clone(), simulation.clone(), *tally).save(&self.path)?;
        self.skip_to(simulation);
        Ok(())
    }

    /// Removes it: the run is complete, and nothing goes on from there.
    pub(super) fn remove(self) -> Result<()> {
        remove_if_there(&self.path)
    }
}
