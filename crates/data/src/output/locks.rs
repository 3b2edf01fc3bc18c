//! Locks folders and files to which only one run may write at a time.

use std::fs::{File, OpenOptions, TryLockError};
use std::path::{Path, PathBuf};

use super::terminal::note_line;
use crate::error::{Error, Result, place};

/// Kind of output that only one run at a time may write into a folder. The run locks a file in that folder; the name of
/// this lock file depends on the kind of output. The system ends the lock when the process ends, even if it is killed.
/// A lock file that is left behind has no effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Locked {
    /// Pictures of a run and the files that accompany them.
    Pictures,
    /// A recording of a run. Pictures may be written into the same folder.
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

/// Opens the file whose lock protects `path`, an existing file or folder. This is `path` itself, because a separate
/// lock file could be removed while `path` remains.
///
/// # Errors
/// If the system does not open the file.
#[cfg(not(windows))]
pub fn lock_of(path: &Path) -> std::io::Result<File> {
    File::open(path)
}

/// Opens the file whose lock protects `path`, an existing file or folder. Windows does not lock folders, and even
/// prevents the owner of a lock from reading the file by another handle, so the lock is a separate file.
///
/// # Errors
/// If the system does not open the file.
#[cfg(windows)]
pub fn lock_of(path: &Path) -> std::io::Result<File> {
    let lock = if path.is_dir() {
        path.join(".slump-shared.lock")
    } else {
        path.with_added_extension("lock")
    };
    OpenOptions::new().create(true).truncate(false).write(true).open(lock)
}

/// A folder into which several processes write different files at the same time, unless one of them locks the folder
/// exclusively.
pub struct SharedFolder {
    path: PathBuf,
    folder: File,
}

impl SharedFolder {
    /// Locks an existing folder for shared use.
    ///
    /// # Errors
    /// If another process has locked the folder exclusively, or the folder cannot be opened.
    pub fn of(path: &Path) -> Result<Self> {
        let folder = lock_of(path).map_err(|error| Error::file(path, error))?;
        let shared = Self { path: path.to_owned(), folder };
        if shared.is_taken(shared.folder.try_lock_shared()) {
            Err(shared.in_use())
        } else {
            Ok(shared)
        }
    }

    /// Calls a function while no other process uses the folder. If another process uses the folder, returns `None`
    /// without calling the function.
    ///
    /// # Errors
    /// The errors of the function. Also fails if another process locked the folder exclusively in the meantime.
    pub fn alone<T>(&self, act: impl FnOnce() -> Result<T>) -> Result<Option<T>> {
        // A shared lock cannot be turned into an exclusive lock, so it is released first.
        let _ = self.folder.unlock();
        let done = if self.is_taken(self.folder.try_lock()) { None } else { Some(act()) };
        let _ = self.folder.unlock();
        if self.is_taken(self.folder.try_lock_shared()) {
            Err(self.in_use())
        } else {
            done.transpose()
        }
    }

    /// Returns the error which says that another program is writing into this folder and must end first.
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

/// Returns the error which says that another program is writing a file or a folder and must end first.
pub fn in_use(path: &Path) -> Error {
    Error::file(path, "is being written by another program, which must end first")
}

/// Reports on stderr that a folder cannot be locked, because some file systems have no locks. The run continues:
/// writing without a lock is better than not writing at all.
fn note_unlocked(folder: &Path, error: &std::io::Error) {
    let folder = place(folder);
    note_line(format_args!(
        "{folder}: cannot be locked ({error}), so nothing keeps a second run out"
    ));
}

/// The exclusive right of this process to write one kind of output into a folder, until this value is dropped.
pub struct FolderLock {
    path: PathBuf,
    _file: File,
}

impl FolderLock {
    /// Locks an existing folder for one kind of output.
    ///
    /// # Errors
    /// If another process has locked the folder, or no file can be written in the folder.
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
            // Between opening and locking, another run may have removed the lock file. Then a new lock file is created.
            if is_at(&file, &path) {
                return Ok(Self { path, _file: file });
            }
        }
    }
}

impl Drop for FolderLock {
    fn drop(&mut self) {
        // The lock file is removed while it is still locked. If it cannot be removed, it does no harm.
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
