//! One run at a time in a folder.

use std::fs::{File, OpenOptions, TryLockError};
use std::path::{Path, PathBuf};

use super::lines::note_line;
use crate::error::{Error, Result};

/// What is written in a folder by one run at a time: the name of the file that the run holds locked. The
/// lock ends with the process, however that ends; a file that was left behind locks nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Locked {
    /// Pictures, and what is beside them.
    Pictures,
    /// A recording. Pictures may be in the same folder.
    Recording,
}

impl Locked {
    const fn name(self) -> &'static str {
        match self {
            Self::Pictures => ".slump.lock",
            Self::Recording => ".slump-data.lock",
        }
    }
}

/// A folder in which this process alone writes what is locked until this is dropped.
pub struct FolderLock {
    path: PathBuf,
    _file: File,
}

impl FolderLock {
    /// Locks a folder that is there.
    ///
    /// # Errors
    /// Where another process has it, or no file can be written in it.
    pub fn of(folder: &Path, what: Locked) -> Result<Self> {
        let path = folder.join(what.name());
        loop {
            let file = OpenOptions::new().create(true).truncate(false).write(true).open(&path);
            let file = file.map_err(|error| Error::file(&path, error))?;
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => {
                    let reason = "is being written by another run, which must end first";
                    return Err(Error::file(folder, reason));
                }
                // Some file systems have no locks; to write there at all is worth more.
                Err(TryLockError::Error(error)) => {
                    let folder = folder.display();
                    note_line(format_args!(
                        "{folder}: cannot be locked ({error}), so nothing keeps a second run out"
                    ));
                }
            }
            // Another run may have removed its file between opening and locking it here.
            if is_at(&file, &path) {
                return Ok(Self { path, _file: file });
            }
        }
    }
}

impl Drop for FolderLock {
    fn drop(&mut self) {
        // While it is still locked. A file that stays does no harm.
        let _ = std::fs::remove_file(&self.path);
    }
}

#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let place = |metadata: std::fs::Metadata| (metadata.dev(), metadata.ino());
    let there = std::fs::metadata(path).ok().map(place);
    there.is_some() && file.metadata().ok().map(place) == there
}

#[cfg(not(unix))]
fn is_at(_: &File, path: &Path) -> bool {
    path.exists()
}
