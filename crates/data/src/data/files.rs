//! Which files of a folder are a recording's.

use std::io::ErrorKind::NotFound;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::output::name_of_whole;

/// The plain files of a folder whose names are a recording's, sorted, with what a kill left of such; none
/// where there is no folder. Links and pipes are nobody's leftovers.
///
/// # Errors
/// Where the folder cannot be read.
pub(super) fn named(folder: &Path, is_ours: impl Fn(&str) -> bool) -> Result<Vec<PathBuf>> {
    let refuse = |error| Error::file(folder, error);
    let entries = match std::fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(error) if error.kind() == NotFound => return Ok(Vec::new()),
        Err(error) => return Err(refuse(error)),
    };
    let mut files = Vec::new();
    for entry in entries {
        let entry = entry.map_err(refuse)?;
        let is_plain = entry.file_type().map_err(refuse)?.is_file();
        if is_plain && entry.file_name().to_str().is_some_and(|name| is_ours(name_of_whole(name))) {
            files.push(entry.path());
        }
    }
    files.sort();
    Ok(files)
}

/// Whether a file is what a kill left of one.
pub(super) fn is_left(path: &Path) -> bool {
    let name = path.file_name().and_then(|name| name.to_str());
    name.is_some_and(|name| name_of_whole(name) != name)
}

/// Removes a file.
///
/// # Errors
/// Names the file and what the system says.
pub(super) fn remove(path: &Path) -> Result<()> {
    std::fs::remove_file(path).map_err(|error| Error::file(path, error))
}

/// Makes a folder where it is not there.
///
/// # Errors
/// Names the folder and what the system says.
pub(super) fn make_folder(path: &Path) -> Result<()> {
    std::fs::create_dir_all(path)
        .map_err(|error| Error::file(path, format!("cannot be written to ({error})")))
}
