//! Where a file that is to be written goes.

use std::fs::Permissions;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};

/// Links that lead on to links; more than the system itself follows are a circle.
const MOST_LINKS: usize = 40;

/// The folder that a file is in.
pub fn folder_of(path: &Path) -> &Path {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    folder.unwrap_or(Path::new("."))
}

/// What a path leads to, behind all symbolic links.
pub(super) struct Target {
    pub path: PathBuf,
    /// Those of the file that is there.
    pub permissions: Option<Permissions>,
    /// Whether what is there is no plain file: a device, a pipe, a socket.
    special: bool,
}

impl Target {
    /// # Errors
    /// Where links go in a circle.
    pub(super) fn of(path: &Path) -> Result<Self> {
        let mut target = path.to_owned();
        for _ in 0..MOST_LINKS {
            let Ok(link) = std::fs::read_link(&target) else {
                let there = std::fs::metadata(&target).ok();
                let special =
                    there.as_ref().is_some_and(|there| !there.is_file() && !there.is_dir());
                let permissions = there.filter(std::fs::Metadata::is_file);
                let permissions = permissions.map(|there| there.permissions());
                return Ok(Self { path: target, permissions, special });
            };
            // The links of open files name no place: they are followed by the system alone.
            if target.starts_with("/proc") || target.starts_with("/dev") {
                return Ok(Self { path: target, permissions: None, special: true });
            }
            target = folder_of(&target).join(link);
        }
        Err(Error::file(path, "is a symbolic link that leads back to itself"))
    }

    /// Whether it must not be replaced by a file.
    pub(super) fn is_written_straight(&self) -> bool {
        self.special
    }
}
