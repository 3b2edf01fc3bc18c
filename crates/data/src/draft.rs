//! Creates temporary files without a name, in which output is collected until it is complete: on a disk, or in memory
//! if there is no disk.

use std::path::Path;

/// A temporary file without a name, on a disk.
#[cfg(not(target_arch = "wasm32"))]
pub type DraftFile = std::fs::File;
/// A temporary file without a name, in memory.
#[cfg(target_arch = "wasm32")]
pub type DraftFile = crate::memory::MemoryFile;

/// Creates a temporary file without a name in a folder. The system deletes it when the process ends, even if the
/// process is killed.
///
/// # Errors
/// If the system cannot create a file.
#[cfg(not(target_arch = "wasm32"))]
pub fn nameless_file(folder: &Path) -> std::io::Result<DraftFile> {
    tempfile::tempfile_in(folder)
}

/// Creates a temporary file without a name in memory.
///
/// # Errors
/// Never.
#[cfg(target_arch = "wasm32")]
pub fn nameless_file(_: &Path) -> std::io::Result<DraftFile> {
    Ok(DraftFile::default())
}
