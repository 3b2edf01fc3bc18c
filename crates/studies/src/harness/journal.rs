//! Reads and writes journals of results. A journal has one line of JSON per case (a run of a study or an experiment).
//! The line is appended when the case ends, so if the program is killed, all finished cases are still there. Each line
//! has a checksum. An incomplete last line, which a killed program can leave, is cut off; a damaged line is reported
//! and ignored. Stored initial states use the same kind of checksum.

use std::collections::HashMap;
use std::fs::{File, OpenOptions};
use std::io::{ErrorKind::NotFound, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::case::FinishedCase;
use crate::error::{Error, Result};
use crate::output::{in_use, is_recognised, lock_of, note_line};

const ENDING: &str = "jsonl";

pub(crate) fn path_of(folder: &Path, name: &str) -> PathBuf {
    folder.join(format!("{name}.{ENDING}"))
}

pub(crate) struct Journal {
    path: PathBuf,
    file: Mutex<File>,
    /// Lock of the journal file. It is held as long as the journal is open, so that no other program writes to the
    /// file.
    _lock: File,
}

impl Journal {
    /// Opens a journal for appending. An incomplete last line is cut off. Damaged lines are reported and overwritten
    /// with spaces.
    pub(crate) fn open(folder: &Path, name: &str) -> Result<Self> {
        let path = path_of(folder, name);
        let refuse = |error: std::io::Error| Error::file(&path, error);
        let file = OpenOptions::new().create(true).read(true).append(true).open(&path);
        let file = file.map_err(refuse)?;
        let lock = lock_of(&path).map_err(refuse)?;
        lock.try_lock().map_err(|_| in_use(&path))?;
        if !is_recognised(&path)? {
            let reason = "holds no record of this program, but must be its journal or not be there";
            return Err(Error::file(&path, reason));
        }
        let bytes = std::fs::read(&path).map_err(refuse)?;
        let whole = bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |last| last + 1);
        file.set_len(whole as u64).map_err(refuse)?;
        blank_damaged(&path, &bytes[..whole]).map_err(refuse)?;
        Ok(Self { path, file: Mutex::new(file), _lock: lock })
    }

    pub(crate) fn add(&self, entry: &impl Serialize) -> Result<()> {
        let line = serde_json::to_string(entry).map_err(|error| Error::file(&self.path, error))?;
        let line = sealed_line(&line);
        let mut file = match self.file.lock() {
            Ok(file) => file,
            // The lock is poisoned if another thread panicked while it held the lock. The file is intact even then,
            // because a thread can only panic before or after it writes a line.
            Err(poisoned) => poisoned.into_inner(),
        };
        // Each line is one write, so if the program is killed between two writes, the file contains only complete
        // lines.
        file.write_all(line.as_bytes()).map_err(|error| Error::file(&self.path, error))
    }
}

/// Reads all finished cases (runs) from the journals in `folders`. The key of the returned map is the unique name of
/// the case. Fails if the same case has two different results.
pub(crate) fn read_all<T: Serialize + DeserializeOwned>(
    folders: &[PathBuf],
) -> Result<HashMap<String, FinishedCase<T>>> {
    let mut all: HashMap<String, FinishedCase<T>> = HashMap::new();
    for path in journals(folders)? {
        for case in read::<FinishedCase<T>>(&path)? {
            // Results are compared as JSON texts, because the number NaN is not equal to itself.
            let written = |case: &FinishedCase<T>| serde_json::to_string(&case.result).ok();
            if let Some(known) = all.get(&case.key)
                && written(known) != written(&case)
            {
                let reason = format!("run {} came out otherwise before", case.key);
                return Err(Error::file(&path, reason));
            }
            all.insert(case.key.clone(), case);
        }
    }
    Ok(all)
}

/// Reads the results that the lines of one journal contain. Damaged lines are reported and left out.
pub(crate) fn read<T: DeserializeOwned>(path: &Path) -> Result<Vec<T>> {
    let bytes = std::fs::read(path).map_err(|error| Error::file(path, error))?;
    let mut entries = Vec::new();
    for (number, line) in lines(&bytes) {
        let entry = record_of(line).and_then(|record| serde_json::from_str(record).ok());
        match entry {
            Some(entry) => entries.push(entry),
            None => note_damage(path, number),
        }
    }
    Ok(entries)
}

/// Returns the complete, non-blank lines of a journal, each with its line number, counted from 1.
fn lines(bytes: &[u8]) -> impl Iterator<Item = (usize, &[u8])> {
    let whole = bytes.iter().rposition(|&byte| byte == b'\n').unwrap_or(0);
    let lines = bytes[..whole].split(|&byte| byte == b'\n').zip(1..);
    lines.map(|(line, number)| (number, line)).filter(|(_, line)| !line.trim_ascii().is_empty())
}

fn note_damage(path: &Path, line: usize) {
    note_line(format_args!(
        "{}: line {line} is damaged; what it told of is computed anew",
        path.display()
    ));
}

/// Overwrites damaged lines of a journal with spaces, so that each damaged line is reported only once. If the program
/// is killed during this work, the remaining damaged lines are reported again next time.
fn blank_damaged(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    // A file that is open for appending can only be written at its end, so the file is opened a second time.
    let mut file = OpenOptions::new().write(true).open(path)?;
    for (number, line) in lines(bytes).filter(|(_, line)| record_of(line).is_none()) {
        note_damage(path, number);
        // `line` is a slice of `bytes`, so the difference of the two addresses is the position of the line in the file.
        let offset = line.as_ptr().addr() - bytes.as_ptr().addr();
        file.seek(SeekFrom::Start(offset as u64))?;
        file.write_all(&vec![b' '; line.len()])?;
    }
    Ok(())
}

pub(crate) fn journals(folders: &[PathBuf]) -> Result<Vec<PathBuf>> {
    let mut paths = Vec::new();
    for folder in folders {
        let files = files_in(folder)?.into_iter();
        paths.extend(files.filter(|path| path.extension().is_some_and(|it| it == ENDING)));
    }
    paths.sort();
    Ok(paths)
}

/// Returns the paths of all files and folders in a folder. Returns an empty list if the folder does not exist.
pub(crate) fn files_in(folder: &Path) -> Result<Vec<PathBuf>> {
    let entries = match std::fs::read_dir(folder) {
        Err(error) if error.kind() == NotFound => return Ok(Vec::new()),
        entries => entries.map_err(|error| Error::file(folder, error))?,
    };
    let path = |entry: std::io::Result<std::fs::DirEntry>| entry.map(|entry| entry.path());
    entries.map(path).collect::<std::io::Result<_>>().map_err(|error| Error::file(folder, error))
}

/// Returns the paths of all journals (files of results) in a folder.
///
/// # Errors
/// If another program has one of the journals open.
pub(crate) fn free_journals(folder: &Path) -> Result<Vec<PathBuf>> {
    let paths = journals(&[folder.to_owned()])?;
    let is_in_use =
        |path: &&PathBuf| lock_of(path).is_ok_and(|lock| lock.try_lock_shared().is_err());
    match paths.iter().find(is_in_use) {
        Some(path) => Err(in_use(path)),
        None => Ok(paths),
    }
}

/// Number of hexadecimal digits of a checksum. 64 bits are more than enough to detect damage.
const DIGITS: usize = 16;
const BEFORE: &str = "{\"checksum\":\"";
const BETWEEN: &str = "\",\"record\":";
/// Text before the checksum in the last line of a stored text file, such as a file of grains. In such files, comments
/// begin with `#`.
const COMMENT: &str = "# checksum ";

pub(crate) fn checksum(text: &[u8]) -> String {
    blake3::hash(text).to_hex()[..DIGITS].to_owned()
}

/// Returns a line of a journal: a JSON object that contains the record, which is JSON itself, and the record's
/// checksum.
fn sealed_line(record: &str) -> String {
    format!("{BEFORE}{}{BETWEEN}{record}}}\n", checksum(record.as_bytes()))
}

/// Returns the record in a line of a journal, which is given without its line end. Returns `None` if the line is
/// damaged.
fn record_of(line: &[u8]) -> Option<&str> {
    let rest = str::from_utf8(line).ok()?.strip_prefix(BEFORE)?;
    let (found, rest) = rest.split_at_checked(DIGITS)?;
    let record = rest.strip_prefix(BETWEEN)?.strip_suffix('}')?;
    (checksum(record.as_bytes()) == found).then_some(record)
}

/// Appends a comment with the text's checksum to a text, as the last line.
pub(crate) fn sealed_text(text: &str) -> String {
    format!("{text}{COMMENT}{}\n", checksum(text.as_bytes()))
}

/// Returns the text of a file written by [`sealed_text`], without the checksum. Returns `None` if the file is damaged.
pub(crate) fn text_of(bytes: &[u8]) -> Option<&str> {
    let (text, found) = str::from_utf8(bytes).ok()?.rsplit_once(COMMENT)?;
    (checksum(text.as_bytes()) == found.strip_suffix('\n')?).then_some(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_flipped_bit_goes_unseen() {
        let line = sealed_line("{\"key\":\"ab\",\"slump\":0.25}");
        let line = line.trim_end().as_bytes();
        let text = sealed_text("# A state.\nx,y,radius\n1,2,3\n");
        assert_eq!(record_of(line), Some("{\"key\":\"ab\",\"slump\":0.25}"));
        assert_eq!(text_of(text.as_bytes()), Some("# A state.\nx,y,radius\n1,2,3\n"));
        let flipped = |bytes: &[u8], bit: usize| {
            let mut bytes = bytes.to_vec();
            bytes[bit / 8] ^= 1 << (bit % 8);
            bytes
        };
        for bit in 0..8 * line.len() {
            assert_eq!(record_of(&flipped(line, bit)), None, "bit {bit}");
        }
        for bit in 0..8 * text.len() {
            assert_eq!(text_of(&flipped(text.as_bytes(), bit)), None, "bit {bit}");
        }
        for end in 0..text.len() {
            assert_eq!(text_of(&text.as_bytes()[..end]), None, "cut at {end}");
        }
    }
}
