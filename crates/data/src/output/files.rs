//! Files that are whole or not there, and where they go.

use std::fs::File;
use std::io::ErrorKind::NotFound;
use std::path::Path;

use super::draft::Draft;
use super::target::{Target, folder_of};
use crate::error::{Error, Result};

/// Makes `folder` if it is not there and checks that files can be written in it. `field` is what asks for
/// it, for messages.
///
/// # Errors
/// Names the field and the folder, and says what the system says.
pub fn check_writable(field: &str, folder: &Path) -> Result<()> {
    try_to_write(folder).map_err(|error| {
        let allowed = format!("a folder that can be written to ({error})");
        Error::value(field, folder.display(), allowed)
    })
}

/// Checks that a file can be written at `path`, and makes its folder if it is not there. `field` is what
/// asks for it, for messages.
///
/// # Errors
/// Names the field and the file, and says what is in the way.
pub fn check_file(field: &str, path: &Path) -> Result<()> {
    let refuse = |allowed: &str| Err(Error::value(field, path.display(), allowed));
    let target = Target::of(path)?;
    if target.is_written_straight() {
        return Ok(());
    }
    if target.path.is_dir() {
        return refuse("a file, and this is a folder");
    }
    if target.permissions.is_some_and(|permissions| permissions.readonly()) {
        return refuse("a file that can be written to, and this one is read-only");
    }
    try_to_write(folder_of(&target.path))
        .or_else(|error| refuse(&format!("a file in a folder that can be written to ({error})")))
}

fn try_to_write(folder: &Path) -> std::io::Result<()> {
    std::fs::create_dir_all(folder)?;
    tempfile::tempfile_in(folder).map(drop)
}

/// Writes a file in one go: a run that is stopped leaves no half file behind and destroys none.
///
/// # Errors
/// Names the file and what the system says.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<()> {
    let mut draft = Draft::start(path)?;
    draft.write(bytes)?;
    draft.finish(true)
}

/// An empty file that is there from the start, for what is to be kept as it comes.
pub(crate) fn start_stream(path: &Path) -> Result<File> {
    File::create(path).map_err(|error| Error::file(path, format!("cannot be written ({error})")))
}

/// Removes a file, where it is there.
///
/// # Errors
/// Names the file and what the system says.
pub fn remove_if_there(path: &Path) -> Result<()> {
    unless_absent(path, std::fs::remove_file(path))
}

/// Removes a folder with all that is in it, where it is there.
///
/// # Errors
/// Names the folder and what the system says.
pub fn remove_folder_if_there(path: &Path) -> Result<()> {
    unless_absent(path, std::fs::remove_dir_all(path))
}

fn unless_absent(path: &Path, removed: std::io::Result<()>) -> Result<()> {
    match removed {
        Err(error) if error.kind() != NotFound => Err(Error::file(path, error)),
        _ => Ok(()),
    }
}
