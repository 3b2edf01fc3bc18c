//! A file that has its name only once it is whole.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use super::target::{Target, folder_of};
use crate::error::{Error, Result};

/// Ending of the name that a whole file has for the moment in which it takes the place of another.
const LEFT: &str = ".part";

/// The name that a file was about to have, where `name` is what a kill in that moment leaves of it,
/// `.NAME.NUMBERS.part`: hidden, so that readers of whole folders pass it by. Any other name is its own.
pub fn name_of_whole(name: &str) -> &str {
    let is_number = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit() || byte == b'-');
    let inner = name.strip_prefix('.').and_then(|rest| rest.strip_suffix(LEFT));
    match inner.and_then(|rest| rest.rsplit_once('.')) {
        Some((whole, numbers)) if is_number(numbers) => whole,
        _ => name,
    }
}

/// A file that has its name only once it is whole, so that a run that is stopped leaves no half file
/// behind and destroys none. Devices and pipes are written to as they are.
pub struct Draft {
    /// As the user wrote it.
    path: PathBuf,
    target: Target,
    place: Place,
}

/// Where a draft is until it has its name.
enum Place {
    /// In no folder: it is gone with the process, however that ends.
    #[cfg(target_os = "linux")]
    Unnamed(File),
    /// Beside its target, where the file system knows no files without a name.
    Named(NamedTempFile),
    /// At its target.
    Straight(File),
}

impl Draft {
    /// Starts a file.
    ///
    /// # Errors
    /// Names the file and what the system says.
    pub fn start(path: &Path) -> Result<Self> {
        let refuse = |error| Error::file(path, format!("cannot be written ({error})"));
        let target = Target::of(path)?;
        let place = if target.is_written_straight() {
            Place::Straight(File::options().write(true).open(&target.path).map_err(refuse)?)
        } else {
            Self::beside(&target).map_err(refuse)?
        };
        Ok(Self { path: path.to_owned(), target, place })
    }

    fn beside(target: &Target) -> std::io::Result<Place> {
        let folder = folder_of(&target.path);
        #[cfg(target_os = "linux")]
        if let Some(file) = unnamed::start(folder) {
            return Ok(Place::Unnamed(file));
        }
        let mut builder = tempfile::Builder::new();
        #[cfg(unix)]
        let all = std::os::unix::fs::PermissionsExt::from_mode(0o666);
        #[cfg(unix)]
        builder.permissions(all);
        builder.tempfile_in(folder).map(Place::Named)
    }

    /// What to write to.
    pub fn file(&mut self) -> &mut File {
        match &mut self.place {
            #[cfg(target_os = "linux")]
            Place::Unnamed(file) => file,
            Place::Named(file) => file.as_file_mut(),
            Place::Straight(file) => file,
        }
    }

    /// Writes.
    ///
    /// # Errors
    /// Names the file and what the system says.
    pub fn write(&mut self, bytes: &[u8]) -> Result<()> {
        let outcome = self.file().write_all(bytes);
        outcome.map_err(|error| Error::file(&self.path, error))
    }

    /// Gives the file its name. With `safe` it is on the disk before the name is, so that even a
    /// machine that falls over leaves the old file or the new one.
    ///
    /// # Errors
    /// Names the file and what the system says.
    pub fn finish(self, safe: bool) -> Result<()> {
        let path = self.path.clone();
        self.put(safe).map_err(|error| Error::file(path, error))
    }

    fn put(mut self, safe: bool) -> std::io::Result<()> {
        if matches!(self.place, Place::Straight(_)) {
            return Ok(());
        }
        if let Some(before) = self.target.permissions.clone() {
            self.file().set_permissions(before)?;
        }
        if safe {
            self.file().sync_all()?;
        }
        match self.place {
            #[cfg(target_os = "linux")]
            Place::Unnamed(file) => unnamed::name(&file, &self.target.path),
            Place::Named(file) => file.persist(&self.target.path).map(drop).map_err(Into::into),
            Place::Straight(_) => Ok(()),
        }
    }
}

/// Files that are in no folder yet.
#[cfg(target_os = "linux")]
mod unnamed {
    use std::ffi::OsString;
    use std::fs::File;
    use std::io::{ErrorKind, Result};
    use std::os::fd::AsRawFd;
    use std::path::Path;
    use std::sync::atomic::{AtomicU64, Ordering};

    use rustix::fs::{AtFlags, CWD, Mode, OFlags, linkat, open};

    /// By which such a file is named.
    const DESCRIPTORS: &str = "/proc/self/fd";

    /// A file in no folder, on the file system of `folder`; none where that has no such files.
    pub(super) fn start(folder: &Path) -> Option<File> {
        if !Path::new(DESCRIPTORS).exists() {
            return None;
        }
        let flags = OFlags::TMPFILE | OFlags::WRONLY | OFlags::CLOEXEC;
        open(folder, flags, Mode::from_raw_mode(0o666)).ok().map(File::from)
    }

    /// Puts the file in the place of whatever is at `target`.
    pub(super) fn name(file: &File, target: &Path) -> Result<()> {
        match link(file, target) {
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            outcome => return outcome,
        }
        // A link replaces nothing; a rename does, in one go.
        static NUMBER: AtomicU64 = AtomicU64::new(0);
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let Some(name) = target.file_name() else { return Err(ErrorKind::InvalidInput.into()) };
        let mut hidden = OsString::from(".");
        hidden.push(name);
        hidden.push(format!(".{}-{number}{}", std::process::id(), super::LEFT));
        let beside = target.with_file_name(hidden);
        link(file, &beside)?;
        std::fs::rename(&beside, target).inspect_err(|_| {
            let _ = std::fs::remove_file(&beside);
        })
    }

    fn link(file: &File, target: &Path) -> Result<()> {
        let from = format!("{DESCRIPTORS}/{}", file.as_raw_fd());
        Ok(linkat(CWD, from, CWD, target, AtFlags::SYMLINK_FOLLOW)?)
    }
}
