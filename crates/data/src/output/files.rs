//! Writes files completely or not at all, checks that output files can be written at given paths, and collects the
//! descriptive texts (such as title and settings) that are stored in files.

use std::borrow::Cow;
use std::ffi::OsStr;
use std::fs::{File, Metadata, Permissions};
use std::io::{
    ErrorKind::{InvalidFilename, NotFound},
    Seek, Write,
};
use std::path::{Path, PathBuf};

use crate::draft::{DraftFile, nameless_file};
use crate::error::{self, Error, Result};

/// Ending of the name of a draft, a file that is not complete yet.
const ENDING_OF_DRAFT: &str = ".part";
/// Length of the longest file name whose draft (the incomplete file) still has a name that all common file systems
/// accept, bytes. They accept 255 bytes, and a draft's name has `.` in front, and `.`, six letters and the ending
/// behind.
#[cfg(not(target_arch = "wasm32"))]
const MOST_OF_NAME: usize = 255 - 8 - ENDING_OF_DRAFT.len();
/// Number of symbolic links after which a chain of links counts as a cycle, which never leads to a file. Linux follows
/// no more than 40 links, either.
const MOST_LINKS: usize = 40;

/// Converts the name of a draft (an incomplete file that a killed process left), `.NAME.LETTERS.part`, to the name that
/// the complete file should have. Other names are returned unchanged. Drafts are hidden files, so that programs that
/// read whole folders skip them.
pub fn final_name(name: &str) -> &str {
    let inner = name.strip_prefix('.').and_then(|rest| rest.strip_suffix(ENDING_OF_DRAFT));
    match inner.and_then(|rest| rest.rsplit_once('.')) {
        Some((whole, letters))
            if letters.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'-') =>
        {
            whole
        }
        _ => name,
    }
}

/// A file that gets its name only when it is complete. A run that is stopped therefore leaves no incomplete file and
/// destroys no existing file. Devices and pipes are written directly.
pub struct PendingFile {
    /// The path of the file as the user wrote it.
    path: PathBuf,
    destination: Destination,
    /// The incomplete file. It has no name, so it disappears with the process, however the process ends.
    file: DraftFile,
}

impl PendingFile {
    /// Starts writing a file that will get the path `path` when it is complete.
    ///
    /// # Errors
    /// The error names the file and gives the system's message.
    pub fn start(path: &Path) -> Result<Self> {
        let destination = Destination::of(path)?;
        let file = destination
            .draft()
            .map_err(|error| Error::file(path, format!("cannot be written ({error})")))?;
        Ok(Self { path: path.to_owned(), destination, file })
    }

    /// Returns the incomplete file, for writing.
    pub fn file(&mut self) -> &mut DraftFile {
        &mut self.file
    }

    /// Writes bytes at the end of the incomplete file.
    ///
    /// # Errors
    /// The error names the file and gives the system's message.
    pub fn write(&mut self, bytes: &[u8]) -> Result<()> {
        self.file.write_all(bytes).map_err(|error| Error::file(&self.path, error))
    }

    /// Completes the file and gives it its name. If `safe` is true, the data are on the disk before the file gets its
    /// name, so that even a crash of the machine leaves either the old file or the new file.
    ///
    /// # Errors
    /// The error names the file and gives the system's message.
    pub fn finish(mut self, safe: bool) -> Result<()> {
        if self.destination.is_special {
            return Ok(());
        }
        self.put(safe).map_err(|error| Error::file(&self.path, error))
    }

    /// Stores the file in memory, from which the web page can fetch it.
    #[cfg(target_arch = "wasm32")]
    fn put(&mut self, _safe: bool) -> std::io::Result<()> {
        crate::memory::keep_written(&self.destination.path, &self.file);
        Ok(())
    }

    /// Copies the data to a draft (a hidden, incomplete file) in the folder of the destination, and then renames the
    /// draft to the name of the destination in a single operation.
    #[cfg(not(target_arch = "wasm32"))]
    fn put(&mut self, safe: bool) -> std::io::Result<()> {
        let Destination { path, permissions, .. } = &self.destination;
        let name = shortened(path.file_name().unwrap_or_default());
        let prefix = [".".as_ref(), &*name, ".".as_ref()].join(OsStr::new(""));
        // The draft is created with the usual permissions of a new file, which the umask sets.
        let mut draft = tempfile::Builder::new()
            .prefix(&prefix)
            .suffix(ENDING_OF_DRAFT)
            .make_in(folder_of(path), |draft| File::create_new(draft))?;
        self.file.rewind()?;
        std::io::copy(&mut self.file, draft.as_file_mut())?;
        if let Some(permissions) = permissions {
            draft.as_file().set_permissions(permissions.clone())?;
        }
        if safe {
            draft.as_file().sync_all()?;
        }
        draft.persist(path)?;
        Ok(())
    }
}

/// Shortens a file name so that the name of the file's draft is not too long.
#[cfg(not(target_arch = "wasm32"))]
fn shortened(name: &OsStr) -> Cow<'_, OsStr> {
    if name.len() <= MOST_OF_NAME {
        return Cow::Borrowed(name);
    }
    let text = name.to_string_lossy();
    Cow::Owned(text[..text.floor_char_boundary(MOST_OF_NAME)].into())
}

/// Returns the folder of a file; `.` if the path has no folder.
pub fn folder_of(path: &Path) -> &Path {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    folder.unwrap_or(Path::new("."))
}

/// Destination of a path after all symbolic links are followed.
struct Destination {
    path: PathBuf,
    /// Permissions of the file that already exists at this path; `None` if there is no plain file.
    permissions: Option<Permissions>,
    /// True if the destination is not a plain file but a device, a pipe or a socket, which must not be replaced.
    is_special: bool,
}

impl Destination {
    fn of(path: &Path) -> Result<Self> {
        let mut path_there = path.to_owned();
        for _ in 0..MOST_LINKS {
            let Ok(link) = std::fs::read_link(&path_there) else {
                let there = std::fs::metadata(&path_there).ok();
                let is_special =
                    there.as_ref().is_some_and(|there| !there.is_file() && !there.is_dir());
                let permissions = there.filter(Metadata::is_file).map(|there| there.permissions());
                return Ok(Self { path: path_there, permissions, is_special });
            };
            // Links in /proc and /dev to open files do not contain a path that can be followed; only the system can
            // follow them.
            if path_there.starts_with("/proc") || path_there.starts_with("/dev") {
                return Ok(Self { path: path_there, permissions: None, is_special: true });
            }
            path_there = folder_of(&path_there).join(link);
        }
        Err(Error::file(path, "is a symbolic link that leads back to itself"))
    }

    /// Returns the file to write to: a file without a name if the destination is a regular file, else the destination
    /// itself (a device or a pipe).
    fn draft(&self) -> std::io::Result<DraftFile> {
        #[cfg(not(target_arch = "wasm32"))]
        if self.is_special {
            return File::options().write(true).open(&self.path);
        }
        nameless_file(folder_of(&self.path))
    }
}

/// Creates `folder` if it does not exist, and checks that files can be written in it. `field` is the name of the
/// option, for error messages.
///
/// # Errors
/// The error names the option and the folder, and gives the system's message.
pub fn check_writable(field: &str, folder: &Path) -> Result<()> {
    error::check(!folder.as_os_str().is_empty(), field, "''", "the name of a folder")?;
    try_to_write(folder).map_err(|error| {
        let allowed = format!("a folder that can be written to ({error})");
        Error::value(field, folder.display(), allowed)
    })
}

/// Checks that a file can be written at `path`, and creates the folder of the file if it does not exist. `field` is the
/// name of the option, for error messages.
///
/// # Errors
/// The error names the option and the file, and gives the reason.
pub fn check_file(field: &str, path: &Path) -> Result<()> {
    let refuse = |allowed: &str| Err(Error::value(field, path.display(), allowed));
    let destination = Destination::of(path)?;
    if destination.is_special {
        return Ok(());
    }
    match destination.path.symlink_metadata() {
        Ok(there) if there.is_dir() => return refuse("a file, and this is a folder"),
        Err(error) if error.kind() == InvalidFilename => {
            return refuse(&format!("a name that a file can have ({error})"));
        }
        _ => {}
    }
    if destination.permissions.is_some_and(|permissions| permissions.readonly()) {
        return refuse("a file that can be written to, and this one is read-only");
    }
    try_to_write(folder_of(&destination.path))
        .or_else(|error| refuse(&format!("a file in a folder that can be written to ({error})")))
}

/// Checks that a new file can be written at `path`, and creates the folder of the file if it does not exist. Fails if a
/// file at `path` exists and is not empty, unless `overwrite` is true, which allows its replacement. `field` is the
/// name of the option, for error messages.
///
/// # Errors
/// The error names the option and the file, and gives the reason.
pub fn check_new_file(field: &str, path: &Path, overwrite: bool) -> Result<()> {
    check_file(field, path)?;
    let is_there = std::fs::metadata(path).is_ok_and(|there| there.is_file() && there.len() > 0);
    if overwrite || !is_there {
        return Ok(());
    }
    let allowed = "a file that is not there yet, unless --overwrite is given to replace it";
    Err(Error::value(field, path.display(), allowed))
}

/// Removes the drafts (incomplete files) that killed processes left in a folder, if the corresponding complete files
/// exist by now.
///
/// # Errors
/// The error names the file and gives the system's message.
pub fn remove_drafts(folder: &Path) -> Result<()> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Ok(()) };
    for name in entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok()) {
        let whole = final_name(&name);
        if whole != name && folder.join(whole).is_file() {
            remove_if_there(&folder.join(&name))?;
        }
    }
    Ok(())
}

/// Resolves all symbolic links in a path, so that two paths that lead to one file give equal results. Returns `None`
/// for a device or a pipe, to which several outputs may be written.
///
/// # Errors
/// If the links form a cycle.
pub fn resolved(path: &Path) -> Result<Option<PathBuf>> {
    let Destination { path, is_special, .. } = Destination::of(path)?;
    // If the folder does not exist, the file does not exist either, and its path is not resolved further.
    let folder = folder_of(&path).canonicalize().unwrap_or_else(|_| folder_of(&path).to_owned());
    Ok((!is_special).then(|| folder.join(path.file_name().unwrap_or_default())))
}

fn try_to_write(folder: &Path) -> std::io::Result<()> {
    if cfg!(not(target_arch = "wasm32")) {
        std::fs::create_dir_all(folder)?;
    }
    nameless_file(folder).map(drop)
}

/// Writes a file completely or not at all. If the run is stopped meanwhile, no incomplete file remains, and an existing
/// file at this path is unchanged.
///
/// # Errors
/// The error names the file and gives the system's message.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<()> {
    let mut file = PendingFile::start(path)?;
    file.write(bytes)?;
    file.finish(true)
}

/// Removes a file if it exists.
///
/// # Errors
/// The error names the file and gives the system's message.
pub fn remove_if_there(path: &Path) -> Result<()> {
    match std::fs::remove_file(path) {
        Err(error) if error.kind() != NotFound => Err(Error::file(path, error)),
        _ => Ok(()),
    }
}

/// Descriptive texts that are stored in an output file, such as title and settings, each with a keyword, in order.
/// Keywords are ASCII with at most 79 characters, as PNG requires.
#[derive(Clone, Debug, PartialEq)]
pub struct Texts(Vec<(String, String)>);

impl Default for Texts {
    /// Creates texts that name only the program and its version.
    fn default() -> Self {
        let program = concat!("slump ", env!("CARGO_PKG_VERSION"));
        Self(vec![("Software".into(), program.into())])
    }
}

impl Texts {
    /// Adds a keyword with its text.
    pub fn add(&mut self, keyword: impl Into<String>, text: impl Into<String>) {
        self.0.push((keyword.into(), text.into()));
    }

    /// Returns the text of a keyword.
    #[cfg(test)]
    pub(crate) fn get(&self, keyword: &str) -> Option<&str> {
        self.0.iter().find(|(name, _)| name == keyword).map(|(_, text)| text.as_str())
    }

    /// Iterates over all keywords with their texts.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &str)> {
        self.0.iter().map(|(keyword, text)| (keyword.as_str(), text.as_str()))
    }

    /// Returns all texts as lines. Each line has the form `KEYWORD: TEXT`.
    pub fn lines(&self) -> String {
        self.iter().map(|(keyword, text)| format!("{keyword}: {text}\n")).collect()
    }
}
