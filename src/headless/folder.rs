//! The folder that a run writes to: its own, and of one run alone.

use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::output::{FolderLock, check_writable};

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
        check_writable(path)?;
        let lock = FolderLock::of(path)?;
        if earlier == Earlier::Refused
            && let Some(name) = files_of_a_run(path)?.first()
        {
            let allowed = format!(
                "a folder without an earlier run's files ({name} is there), unless --overwrite is \
                 given to remove them"
            );
            return Err(Error::value("frames", path.display(), allowed));
        }
        Ok(Self { path: path.to_owned(), earlier, _lock: lock })
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
        let number = name.strip_prefix("frame_").and_then(|rest| rest.strip_suffix(".png"));
        let is_frame =
            number.is_some_and(|digits| digits.bytes().all(|byte| byte.is_ascii_digit()));
        let is_ours = is_frame || ["manifest.json", "observables.csv"].contains(&&*name);
        if is_ours && is_plain(&folder.join(&*name)) {
            names.push(name.into_owned());
        }
    }
    names.sort();
    Ok(names)
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
