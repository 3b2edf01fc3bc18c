//! Folders and files that one run writes at a time.

use std::fs::{File, OpenOptions, TryLockError};
use std::path::{Path, PathBuf};

use super::terminal::note_line;
use crate::error::{Error, Result, place};

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

/// Opens the file whose lock protects `path`, a file or a folder that is there: `path` itself, so that nobody can remove the
/// lock alone.
///
/// # Errors
/// Where the system does not open it.
#[cfg(not(windows))]
pub fn lock_of(path: &Path) -> std::io::Result<File> {
    File::open(path)
}

/// Opens the file whose lock protects `path`, a file or a folder that is there. Windows locks no folder, and keeps even the
/// owner of a lock from reading the file by another handle, so the lock is a file of its own.
///
/// # Errors
/// Where the system does not open it.
#[cfg(windows)]
pub fn lock_of(path: &Path) -> std::io::Result<File> {
    let lock = if path.is_dir() {
        path.join(".slump-shared.lock")
    } else {
        path.with_added_extension("lock")
    };
    OpenOptions::new().create(true).truncate(false).write(true).open(lock)
}

/// A folder that programs write to side by side, each its own part, unless one of them has it alone.
pub struct SharedFolder {
    path: PathBuf,
    folder: File,
}

impl SharedFolder {
    /// Takes a folder that is there.
    ///
    /// # Errors
    /// Where another process has it alone, or it cannot be opened.
    pub fn of(path: &Path) -> Result<Self> {
        let folder = lock_of(path).map_err(|error| Error::file(path, error))?;
        let shared = Self { path: path.to_owned(), folder };
        if shared.is_taken(shared.folder.try_lock_shared()) {
            Err(shared.in_use())
        } else {
            Ok(shared)
        }
    }

    /// Does something while no other process has a part of it; nothing where one has.
    ///
    /// # Errors
    /// Those of what is done, and where another process took it alone in between.
    pub fn alone<T>(&self, act: impl FnOnce() -> Result<T>) -> Result<Option<T>> {
        // A lock that is held is not for changing.
        let _ = self.folder.unlock();
        let done = if self.is_taken(self.folder.try_lock()) { None } else { Some(act()) };
        let _ = self.folder.unlock();
        if self.is_taken(self.folder.try_lock_shared()) {
            Err(self.in_use())
        } else {
            done.transpose()
        }
    }

    /// That it has to be free first.
    pub fn in_use(&self) -> Error {
        in_use(&self.path)
    }

    fn is_taken(&self, locked: std::result::Result<(), TryLockError>) -> bool {
        match locked {
            Ok(()) => false,
            Err(TryLockError::WouldBlock) => true,
            Err(TryLockError::Error(error)) => {
                note_unlocked(&self.path, &error);
                false
            }
        }
    }
}

/// That another program has to end before a file or a folder is written to.
pub fn in_use(path: &Path) -> Error {
    Error::file(path, "is being written by another program, which must end first")
}

/// Some file systems have no locks; to write there at all is worth more.
fn note_unlocked(folder: &Path, error: &std::io::Error) {
    let folder = place(folder);
    note_line(format_args!(
        "{folder}: cannot be locked ({error}), so nothing keeps a second run out"
    ));
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
                Err(TryLockError::Error(error)) => note_unlocked(folder, &error),
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
pub(super) fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let place = |metadata: std::fs::Metadata| (metadata.dev(), metadata.ino());
    let there = std::fs::metadata(path).ok().map(place);
    there.is_some() && file.metadata().ok().map(place) == there
}

#[cfg(not(unix))]
pub(super) fn is_at(_: &File, path: &Path) -> bool {
    path.exists()
}
