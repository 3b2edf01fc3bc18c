//! Files that are whole or not there, where they go, and what they say of themselves.

use std::borrow::Cow;
use std::ffi::OsStr;
use std::fs::{File, Metadata, Permissions};
use std::io::{
    ErrorKind::{InvalidFilename, NotFound},
    Seek, Write,
};
use std::path::{Path, PathBuf};

use crate::draft::{DraftFile, nameless_file};
use crate::error::{Error, Result};

/// Ending of the name that a file has until it is whole.
const ENDING_OF_DRAFT: &str = ".part";
/// Bytes of a name that the file systems in use all take, without what a draft has besides: `.` in front, and `.`, six
/// letters and the ending behind.
#[cfg(not(target_arch = "wasm32"))]
const MOST_OF_NAME: usize = 255 - 8 - ENDING_OF_DRAFT.len();
/// Links that lead on to links; more than the system itself follows are a circle.
const MOST_LINKS: usize = 40;

/// The name that a file was to have, where `name` is what a kill left of it, `.NAME.LETTERS.part`: hidden, so that
/// readers of whole folders pass it by. Any other name is its own.
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

/// A file that has its name only once it is whole, so that a run that is stopped leaves no half file
/// behind and destroys none. Devices and pipes are written to as they are.
pub struct PendingFile {
    /// As the user wrote it.
    path: PathBuf,
    destination: Destination,
    /// In no folder until it is whole: it is gone with the process, however that ends.
    file: DraftFile,
}

impl PendingFile {
    /// Starts a file.
    ///
    /// # Errors
    /// Names the file and what the system says.
    pub fn start(path: &Path) -> Result<Self> {
        let destination = Destination::of(path)?;
        let file = destination
            .draft()
            .map_err(|error| Error::file(path, format!("cannot be written ({error})")))?;
        Ok(Self { path: path.to_owned(), destination, file })
    }

    /// What to write to.
    pub fn file(&mut self) -> &mut DraftFile {
        &mut self.file
    }

    /// Writes.
    ///
    /// # Errors
    /// Names the file and what the system says.
    pub fn write(&mut self, bytes: &[u8]) -> Result<()> {
        self.file.write_all(bytes).map_err(|error| Error::file(&self.path, error))
    }

    /// Gives the file its name. With `safe` it is on the disk before the name is, so that even a
    /// machine that falls over leaves the old file or the new one.
    ///
    /// # Errors
    /// Names the file and what the system says.
    pub fn finish(mut self, safe: bool) -> Result<()> {
        if self.destination.is_special {
            return Ok(());
        }
        self.put(safe).map_err(|error| Error::file(&self.path, error))
    }

    /// Has it fetched by whoever has a place for it.
    #[cfg(target_arch = "wasm32")]
    fn put(&mut self, _safe: bool) -> std::io::Result<()> {
        crate::memory::keep_written(&self.destination.path, &self.file);
        Ok(())
    }

    /// Copies it to a hidden name beside its destination, which it then takes in one go.
    #[cfg(not(target_arch = "wasm32"))]
    fn put(&mut self, safe: bool) -> std::io::Result<()> {
        let Destination { path, permissions, .. } = &self.destination;
        let name = shortened(path.file_name().unwrap_or_default());
        let prefix = [".".as_ref(), &*name, ".".as_ref()].join(OsStr::new(""));
        // With the permissions that the umask leaves to any new file.
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

/// As much of a name as a draft's has room for.
#[cfg(not(target_arch = "wasm32"))]
fn shortened(name: &OsStr) -> Cow<'_, OsStr> {
    if name.len() <= MOST_OF_NAME {
        return Cow::Borrowed(name);
    }
    let text = name.to_string_lossy();
    Cow::Owned(text[..text.floor_char_boundary(MOST_OF_NAME)].into())
}

/// The folder that a file is in.
pub fn folder_of(path: &Path) -> &Path {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    folder.unwrap_or(Path::new("."))
}

/// What a path leads to, behind all symbolic links.
struct Destination {
    path: PathBuf,
    /// Those of the file that is there.
    permissions: Option<Permissions>,
    /// True if what is there is no plain file but a device, a pipe or a socket, which no file must replace.
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
            // The links of open files name no place: they are followed by the system alone.
            if path_there.starts_with("/proc") || path_there.starts_with("/dev") {
                return Ok(Self { path: path_there, permissions: None, is_special: true });
            }
            path_there = folder_of(&path_there).join(link);
        }
        Err(Error::file(path, "is a symbolic link that leads back to itself"))
    }

    /// What is written to until it is whole; what is no plain file at once.
    fn draft(&self) -> std::io::Result<DraftFile> {
        #[cfg(not(target_arch = "wasm32"))]
        if self.is_special {
            return File::options().write(true).open(&self.path);
        }
        nameless_file(folder_of(&self.path))
    }
}

/// Makes `folder` if it is not there and checks that files can be written in it. `field` is what asks for
/// it, for messages.
///
/// # Errors
/// Names the field and the folder, and says what the system says.
pub fn check_writable(field: &str, folder: &Path) -> Result<()> {
    if folder.as_os_str().is_empty() {
        return Err(Error::value(field, "''", "the name of a folder"));
    }
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

/// Checks as [`check_file`] does, and that no file that has anything in it is at `path`, unless it may be replaced
/// (`overwrite`).
///
/// # Errors
/// Names the field and the file, and the reason.
pub fn check_new_file(field: &str, path: &Path, overwrite: bool) -> Result<()> {
    check_file(field, path)?;
    let is_there = std::fs::metadata(path).is_ok_and(|there| there.is_file() && there.len() > 0);
    if overwrite || !is_there {
        return Ok(());
    }
    let allowed = "a file that is not there yet, unless --overwrite is given to replace it";
    Err(Error::value(field, path.display(), allowed))
}

/// Removes the drafts that kills have left in a folder of files that are whole by now.
///
/// # Errors
/// Names the file and what the system says.
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

/// Where the file is that a path leads to, by the one name that its folder has: files that take each other's place have
/// the same. None where it is a device or a pipe, which takes all that comes.
///
/// # Errors
/// Where a link leads back to itself.
pub fn resolved(path: &Path) -> Result<Option<PathBuf>> {
    let Destination { path, is_special, .. } = Destination::of(path)?;
    // Where there is no folder, there is no file.
    let folder = folder_of(&path).canonicalize().unwrap_or_else(|_| folder_of(&path).to_owned());
    Ok((!is_special).then(|| folder.join(path.file_name().unwrap_or_default())))
}

fn try_to_write(folder: &Path) -> std::io::Result<()> {
    if cfg!(not(target_arch = "wasm32")) {
        std::fs::create_dir_all(folder)?;
    }
    nameless_file(folder).map(drop)
}

/// Writes a file in one go: a run that is stopped leaves no half file behind and destroys none.
///
/// # Errors
/// Names the file and what the system says.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<()> {
    let mut file = PendingFile::start(path)?;
    file.write(bytes)?;
    file.finish(true)
}

/// Removes a file, where it is there.
///
/// # Errors
/// Names the file and what the system says.
pub fn remove_if_there(path: &Path) -> Result<()> {
    match std::fs::remove_file(path) {
        Err(error) if error.kind() != NotFound => Err(Error::file(path, error)),
        _ => Ok(()),
    }
}

/// Keywords and texts, in their order. Keywords are ASCII, at most 79 characters: PNG has no others.
#[derive(Clone, Debug, PartialEq)]
pub struct Texts(Vec<(String, String)>);

impl Default for Texts {
    /// The program and its version alone.
    fn default() -> Self {
        let program = concat!("slump ", env!("CARGO_PKG_VERSION"));
        Self(vec![("Software".into(), program.into())])
    }
}

impl Texts {
    /// Says one thing more.
    pub fn add(&mut self, keyword: impl Into<String>, text: impl Into<String>) {
        self.0.push((keyword.into(), text.into()));
    }

    /// The text of a keyword.
    #[cfg(test)]
    pub(crate) fn get(&self, keyword: &str) -> Option<&str> {
        self.0.iter().find(|(name, _)| name == keyword).map(|(_, text)| text.as_str())
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &str)> {
        self.0.iter().map(|(keyword, text)| (keyword.as_str(), text.as_str()))
    }

    /// A line each: keyword, colon, text.
    pub fn lines(&self) -> String {
        self.iter().map(|(keyword, text)| format!("{keyword}: {text}\n")).collect()
    }
}
