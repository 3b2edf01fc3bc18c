//! Creates files without a name, for output that is not complete yet: on a disk, or in memory if there is no disk.

use std::path::Path;

/// A file without a name, on a disk.
#[cfg(not(target_arch = "wasm32"))]
pub type DraftFile = std::fs::File;
/// A file without a name, in memory.
#[cfg(target_arch = "wasm32")]
pub type DraftFile = crate::memory::MemoryFile;

/// Creates a file without a name in a folder. The file disappears with the process, however the process ends.
///
/// # Errors
/// If the system cannot create a file.
#[cfg(not(target_arch = "wasm32"))]
pub fn nameless_file(folder: &Path) -> std::io::Result<DraftFile> {
    tempfile::tempfile_in(folder)
}

/// Creates a file without a name in memory.
///
/// # Errors
/// Never.
#[cfg(target_arch = "wasm32")]
pub fn nameless_file(_: &Path) -> std::io::Result<DraftFile> {
    Ok(DraftFile::default())
}
