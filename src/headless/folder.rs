//! The folder that a run writes to: its own, and of one run alone.

use std::path::{Path, PathBuf};

use super::checkpoint::{CHECKPOINT, WAITING};
use super::manifest::PictureEntry;
use crate::error::{Error, Result};
use crate::output::{FolderLock, Locked, check_writable, final_name};

/// What becomes of the files of an earlier run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Earlier {
    /// Where there are any, the folder is refused.
    Refused,
    /// They are removed.
    Cleared,
    /// They stay: the run goes on with what it began.
    Kept,
}

/// A folder that no other run writes to.
pub(super) struct RunFolder {
    path: PathBuf,
    earlier: Earlier,
    _lock: FolderLock,
}

impl RunFolder {
    /// Makes the folder where it is not there, and takes it for this run.
    ///
    /// # Errors
    /// Where it cannot be written to, another run has it, or it holds what is refused.
    pub(super) fn claim(path: &Path, earlier: Earlier) -> Result<Self> {
        let folder = Self::lock(path, earlier)?;
        folder.check("")?;
        Ok(folder)
    }

    /// The same whatever it holds: that is to be looked at.
    ///
    /// # Errors
    /// Where it cannot be written to, or another run has it.
    pub(super) fn lock(path: &Path, earlier: Earlier) -> Result<Self> {
        check_writable("frames", path)?;
        let lock = FolderLock::of(path, Locked::Pictures)?;
        Ok(Self { path: path.to_owned(), earlier, _lock: lock })
    }

    /// Its path.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Whether a run may go on with what it holds.
    pub(super) fn may_go_on(&self) -> bool {
        self.earlier == Earlier::Refused
    }

    /// Refuses a folder that holds what is refused; `why` says why no run goes on there.
    ///
    /// # Errors
    /// Names the first file.
    pub(super) fn check(&self, why: &str) -> Result<()> {
        if self.earlier != Earlier::Refused {
            return Ok(());
        }
        let Some(name) = files_of_a_run(&self.path)?.into_iter().next() else { return Ok(()) };
        let allowed = format!(
            "a folder without an earlier run's files ({name} is there{why}), unless --overwrite is \
             given to remove them"
        );
        Err(Error::value("frames", self.path.display(), allowed))
    }

    /// Removes the pictures in it but for these, which the run goes on with, and what a kill has left half
    /// named.
    ///
    /// # Errors
    /// Names a picture that is not there, or that cannot be removed.
    pub(super) fn keep_pictures(&self, pictures: &[PictureEntry]) -> Result<()> {
        let is_kept = |name: &str| pictures.iter().any(|picture| picture.file == name);
        let names = files_of_a_run(&self.path)?;
        if let Some(lost) = pictures.iter().find(|picture| !names.contains(&picture.file)) {
            let reason = "is missing, but must be where the checkpoint tells of it";
            return Err(Error::file(self.path.join(&lost.file), reason));
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
        if self.earlier != Earlier::Cleared {
            return Ok(());
        }
        let mut names = files_of_a_run(&self.path)?;
        names.extend(told_of(&self.path));
        for path in names.iter().map(|name| self.path.join(name)).filter(|path| is_plain(path)) {
            std::fs::remove_file(&path).map_err(|error| Error::file(&path, error))?;
        }
        Ok(())
    }
}

/// The names that every run uses, of those that are there.
fn files_of_a_run(folder: &Path) -> Result<Vec<String>> {
    let refuse = |error| Error::file(folder, error);
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(refuse)? {
        let name = entry.map_err(refuse)?.file_name();
        let name = name.to_string_lossy();
        let whole = final_name(&name);
        let is_ours = is_frame(whole)
            || ["manifest.json", "observables.csv", CHECKPOINT, WAITING].contains(&whole);
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
