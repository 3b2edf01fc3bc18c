//! Keeps files in memory for the browser version, which has no disk. The web page can give files to the program to
//! read, and can fetch the files that the program has written.

#![cfg_attr(
    not(target_arch = "wasm32"),
    allow(unreachable_pub, reason = "only tests use it there")
)]

use std::collections::BTreeMap;
use std::io::{Cursor, Read, Result, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A file in memory. Copies of this value are handles of the same file and share one position for reading and writing.
#[derive(Clone, Debug, Default)]
pub struct MemoryFile(Arc<Mutex<Cursor<Vec<u8>>>>);

impl MemoryFile {
    /// Creates a file with the content `bytes`.
    pub fn of(bytes: Vec<u8>) -> Self {
        Self(Arc::new(Mutex::new(Cursor::new(bytes))))
    }

    /// Returns another handle of the file, like [`std::fs::File::try_clone`].
    ///
    /// # Errors
    /// Never.
    pub fn try_clone(&self) -> Result<Self> {
        Ok(self.clone())
    }

    /// Shortens the file to `length` bytes, or extends it with zeros.
    ///
    /// # Errors
    /// Never.
    pub fn set_len(&self, length: u64) -> Result<()> {
        self.cursor().get_mut().resize(length as usize, 0);
        Ok(())
    }

    /// Does nothing, because a file in memory need not be written to a disk.
    ///
    /// # Errors
    /// Never.
    pub fn sync_data(&self) -> Result<()> {
        Ok(())
    }

    /// Returns the whole content of the file.
    pub fn content(&self) -> Vec<u8> {
        self.cursor().get_ref().clone()
    }

    fn cursor(&self) -> MutexGuard<'_, Cursor<Vec<u8>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Read for &MemoryFile {
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize> {
        self.cursor().read(bytes)
    }
}

impl Read for MemoryFile {
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize> {
        self.cursor().read(bytes)
    }
}

impl Write for MemoryFile {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        self.cursor().write(bytes)
    }

    fn flush(&mut self) -> Result<()> {
        Ok(())
    }
}

impl Seek for MemoryFile {
    fn seek(&mut self, to: SeekFrom) -> Result<u64> {
        self.cursor().seek(to)
    }
}

/// Contents of the files that the web page has given to the program to read; the keys are the paths of the files.
static GIVEN: Mutex<BTreeMap<PathBuf, Vec<u8>>> = Mutex::new(BTreeMap::new());
/// Paths and contents of the files that the program has written and the web page has not fetched yet.
static WRITTEN: Mutex<Vec<(PathBuf, Vec<u8>)>> = Mutex::new(Vec::new());

/// Adds a file of the web page, which the program can then read.
pub fn give_file(path: PathBuf, bytes: Vec<u8>) {
    GIVEN.lock().unwrap_or_else(PoisonError::into_inner).insert(path, bytes);
}

/// Opens a file that was added by [`give_file`].
///
/// # Errors
/// If no such file has this path.
pub fn given_file(path: &Path) -> Result<MemoryFile> {
    let given = GIVEN.lock().unwrap_or_else(PoisonError::into_inner);
    let bytes = given.get(path).cloned();
    bytes.map(MemoryFile::of).ok_or_else(|| std::io::ErrorKind::NotFound.into())
}

/// Stores a copy of a written file, which [`written_files`] will return.
pub(crate) fn keep_written(path: &Path, file: &MemoryFile) {
    let mut written = WRITTEN.lock().unwrap_or_else(PoisonError::into_inner);
    written.push((path.to_owned(), file.content()));
}

/// Returns all files that the program has written since the last call, with their paths, and removes them from memory.
pub fn written_files() -> Vec<(PathBuf, Vec<u8>)> {
    std::mem::take(&mut *WRITTEN.lock().unwrap_or_else(PoisonError::into_inner))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_in_memory_reads_writes_and_cuts_as_one_on_disk() {
        let mut file = MemoryFile::default();
        let mut other = file.try_clone().expect("a handle");
        let on_disk = tempfile::tempfile().expect("a file");
        let mut disk = on_disk.try_clone().expect("a handle");
        fn work(one: &mut (impl Read + Write + Seek), two: &mut (impl Write + Seek)) -> Vec<u8> {
            one.write_all(b"grains of sand").expect("written");
            two.seek(SeekFrom::Start(10)).expect("there");
            two.write_all(b"rice!").expect("written");
            one.rewind().expect("there");
            let mut text = Vec::new();
            one.read_to_end(&mut text).expect("read");
            text
        }
        let text = work(&mut file, &mut other);
        assert_eq!(text, work(&mut disk, &mut on_disk.try_clone().expect("a handle")));
        assert_eq!(text, b"grains of rice!");
        file.set_len(6).expect("cut");
        assert_eq!(file.content(), b"grains");
    }

    #[test]
    fn what_is_given_is_read_and_what_is_written_is_fetched_once() {
        give_file("a/scene.toml".into(), b"name".to_vec());
        let mut text = String::new();
        given_file("a/scene.toml".as_ref())
            .expect("given")
            .read_to_string(&mut text)
            .expect("read");
        assert_eq!(text, "name");
        assert!(given_file("scene.toml".as_ref()).is_err());
        keep_written("b.csv".as_ref(), &MemoryFile::of(b"1,2".to_vec()));
        assert_eq!(written_files(), [("b.csv".into(), b"1,2".to_vec())]);
        assert!(written_files().is_empty());
    }
}
