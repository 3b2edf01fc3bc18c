//! Files that are whole or not there, and where they go.

use std::fs::File;
use std::path::Path;

use image::{ImageFormat, RgbaImage};

use super::draft::Draft;
use super::target::{Target, folder_of};
use crate::error::{Error, Result};

/// Makes `folder` if it is not there and checks that files can be written in it.
///
/// # Errors
/// Names the folder and what the system says.
pub(crate) fn check_writable(folder: &Path) -> Result<()> {
    let refuse = |error| Error::file(folder, format!("cannot be written to ({error})"));
    std::fs::create_dir_all(folder).map_err(refuse)?;
    tempfile::tempfile_in(folder).map_err(refuse)?;
    Ok(())
}

/// Checks that a file can be written at `path`, and makes its folder if it is not there.
///
/// # Errors
/// Names the file or its folder and what is in the way.
pub(crate) fn check_file(path: &Path) -> Result<()> {
    let target = Target::of(path)?;
    if target.is_written_straight() {
        return Ok(());
    }
    if target.path.is_dir() {
        return Err(Error::file(path, "is a folder, but must be a file"));
    }
    if target.permissions.is_some_and(|permissions| permissions.readonly()) {
        return Err(Error::file(path, "is there and read-only, but must be a file to write to"));
    }
    check_writable(folder_of(&target.path))
}

/// Writes a file in one go: a run that is stopped leaves no half file behind and destroys none.
///
/// # Errors
/// Names the file and what the system says.
pub(crate) fn write_file(path: &Path, bytes: &[u8]) -> Result<()> {
    let mut draft = Draft::start(path)?;
    draft.write(bytes)?;
    draft.finish(true)
}

/// Writes a picture as PNG. It is not worth waiting for the disk: it can be drawn again.
///
/// # Errors
/// Names the file and what the system says.
pub(crate) fn write_png(path: &Path, image: &RgbaImage) -> Result<()> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write_to(&mut bytes, ImageFormat::Png).map_err(|error| Error::file(path, error))?;
    let mut draft = Draft::start(path)?;
    draft.write(bytes.get_ref())?;
    draft.finish(false)
}

/// An empty file that is there from the start, for what is to be kept as it comes.
pub(crate) fn start_stream(path: &Path) -> Result<File> {
    File::create(path).map_err(|error| Error::file(path, format!("cannot be written ({error})")))
}
