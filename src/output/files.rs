//! Files that are whole or not there.

use std::io::Write;
use std::path::Path;

use image::{ImageFormat, RgbaImage};

use crate::error::{Error, Result};

/// Makes `folder` if it is not there and checks that files can be written in it.
///
/// # Errors
/// Names the folder and what the system says.
pub(crate) fn check_writable(folder: &Path) -> Result<()> {
    let refuse = |error| Error::file(folder, format!("cannot be written to ({error})"));
    std::fs::create_dir_all(folder).map_err(refuse)?;
    tempfile::NamedTempFile::new_in(folder).map_err(refuse)?;
    Ok(())
}

/// Writes a file under another name and then gives it its own, so that a run that is stopped leaves
/// no half file behind and destroys none.
///
/// # Errors
/// Names the file and what the system says.
pub(crate) fn write_file(path: &Path, bytes: &[u8]) -> Result<()> {
    let mut file = start_file(path)?;
    file.write_all(bytes).map_err(|error| Error::file(path, error))?;
    finish_file(file, path)
}

/// Writes a picture as PNG.
///
/// # Errors
/// Names the file and what the system says.
pub(crate) fn write_png(path: &Path, image: &RgbaImage) -> Result<()> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write_to(&mut bytes, ImageFormat::Png).map_err(|error| Error::file(path, error))?;
    write_file(path, bytes.get_ref())
}

/// A file that is there only once it is finished.
pub(crate) fn start_file(path: &Path) -> Result<tempfile::NamedTempFile> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    tempfile::NamedTempFile::new_in(folder.unwrap_or(Path::new(".")))
        .map_err(|error| Error::file(path, format!("cannot be written ({error})")))
}

/// Gives a file its name.
pub(crate) fn finish_file(file: tempfile::NamedTempFile, path: &Path) -> Result<()> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // Temporary files are private; results are as readable as any other file.
        let permissions = std::fs::Permissions::from_mode(0o644);
        file.as_file().set_permissions(permissions).map_err(|error| Error::file(path, error))?;
    }
    file.persist(path).map_err(|error| Error::file(path, error.error))?;
    Ok(())
}
