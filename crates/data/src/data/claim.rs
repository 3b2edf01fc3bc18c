//! The folder that a recording is written to: its own.

use std::path::{Path, PathBuf};

use super::files;
use super::index;
use super::manifest;
use crate::error::{Error, Result};
use crate::output::{FolderLock, Locked, check_writable};
use crate::scene::FormatName;

/// A folder that no other recording is written to while this is there.
pub struct Claim {
    path: PathBuf,
    overwrite: bool,
    _lock: FolderLock,
}

impl Claim {
    /// Makes the folder where it is not there, and takes it.
    ///
    /// # Errors
    /// Where it cannot be written to, another recording is being written to it, or, without `overwrite`, an
    /// earlier one is there.
    pub fn of(path: &Path, overwrite: bool) -> Result<Self> {
        let claim = Self::taken(path)?;
        if !overwrite && let Some(first) = files_of_a_recording(path)?.first() {
            let name = first.strip_prefix(path).unwrap_or(first).display();
            let allowed = format!(
                "a folder without an earlier recording ({name} is there), unless --overwrite is given to \
                 remove it"
            );
            return Err(Error::value("data", path.display(), allowed));
        }
        Ok(Self { overwrite, ..claim })
    }

    /// Takes a folder to go on with the recording that is there, but for what a kill left of its files.
    ///
    /// # Errors
    /// As [`Claim::of`].
    pub fn to_go_on(path: &Path) -> Result<Self> {
        let claim = Self::taken(path)?;
        let mut left = files_of_a_recording(path)?;
        left.retain(|file| files::is_left(file));
        left.iter().try_for_each(|file| files::remove(file))?;
        Ok(claim)
    }

    fn taken(path: &Path) -> Result<Self> {
        check_writable("data", path)?;
        let lock = FolderLock::of(path, Locked::Recording)?;
        Ok(Self { path: path.to_owned(), overwrite: false, _lock: lock })
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Removes an earlier recording, where that was asked for.
    ///
    /// # Errors
    /// Names the file that cannot be removed.
    pub(super) fn clear(&self) -> Result<()> {
        if !self.overwrite {
            return Ok(());
        }
        files_of_a_recording(&self.path)?.iter().try_for_each(|file| files::remove(file))
    }
}

/// The files of a recording that are in a folder, whatever its formats, and what a kill left of such.
fn files_of_a_recording(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut all = files::named(folder, |name| [manifest::FILE, index::FILE].contains(&name))?;
    for format in FormatName::ALL {
        all.extend(super::formats::files(*format, folder)?);
    }
    Ok(all)
}
