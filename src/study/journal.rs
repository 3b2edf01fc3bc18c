//! Results as they come: a line of JSON a run, appended when the run ends, so that a program that is
//! killed loses no finished run. A half line at the end, which a kill can leave, is cut off.

use std::collections::HashMap;
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::Outcome;
use crate::error::{Error, Result};

/// Ending of a journal's name.
const ENDING: &str = "jsonl";

/// Where the journal of that name lies.
pub(super) fn path_of(folder: &Path, name: &str) -> PathBuf {
    folder.join(format!("{name}.{ENDING}"))
}

/// One finished run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Entry {
    /// The run's key.
    pub key: String,
    /// Wall-clock time that it took, s.
    pub wall_secs: f64,
    pub outcome: Outcome,
}

/// A journal that this program writes.
pub(super) struct Journal {
    path: PathBuf,
    file: Mutex<File>,
}

impl Journal {
    /// Opens a journal for appending and cuts off a half line at its end.
    ///
    /// # Errors
    /// Where it cannot be written, or another program is at it.
    pub(super) fn open(folder: &Path, name: &str) -> Result<Self> {
        let path = path_of(folder, name);
        let refuse = |error: std::io::Error| Error::file(&path, error);
        let file = OpenOptions::new().create(true).read(true).append(true).open(&path);
        let file = file.map_err(refuse)?;
        file.try_lock().map_err(|_| {
            Error::file(&path, "is being written by another program, which must end first")
        })?;
        let bytes = std::fs::read(&path).map_err(refuse)?;
        let whole = bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |last| last + 1);
        file.set_len(whole as u64).map_err(refuse)?;
        Ok(Self { path, file: Mutex::new(file) })
    }

    /// Adds something finished.
    pub(super) fn add(&self, entry: &impl Serialize) -> Result<()> {
        let mut line = serde_json::to_vec(entry).map_err(|error| Error::file(&self.path, error))?;
        line.push(b'\n');
        let mut file = match self.file.lock() {
            Ok(file) => file,
            // A thread that fell over between two lines leaves the file sound.
            Err(poisoned) => poisoned.into_inner(),
        };
        // One write a line: a kill between two leaves whole lines.
        file.write_all(&line).map_err(|error| Error::file(&self.path, error))
    }
}

/// All finished runs that the journals of some folders tell of, by key.
///
/// # Errors
/// Where a journal cannot be read, a line of it is none, or two disagree about a run.
pub(super) fn read_all(folders: &[PathBuf]) -> Result<HashMap<String, Entry>> {
    let mut all: HashMap<String, Entry> = HashMap::new();
    for path in journals(folders)? {
        for (number, entry) in read::<Entry>(&path)?.into_iter().enumerate() {
            if let Some(known) = all.get(&entry.key)
                && known.outcome != entry.outcome
            {
                let reason =
                    format!("line {}: run {} came out otherwise before", number + 1, entry.key);
                return Err(Error::file(&path, reason));
            }
            all.insert(entry.key.clone(), entry);
        }
    }
    Ok(all)
}

/// The whole lines of one journal.
///
/// # Errors
/// Where it cannot be read, or a line of it is none.
pub(super) fn read<T: DeserializeOwned>(path: &Path) -> Result<Vec<T>> {
    let text = std::fs::read_to_string(path).map_err(|error| Error::file(path, error))?;
    let whole = text.rfind('\n').map_or("", |last| &text[..=last]);
    let entries = whole.lines().enumerate().map(|(number, line)| {
        serde_json::from_str(line)
            .map_err(|error| Error::file(path, format!("line {}: {error}", number + 1)))
    });
    entries.collect()
}

/// The journals of some folders, in the order of their names.
pub(super) fn journals(folders: &[PathBuf]) -> Result<Vec<PathBuf>> {
    let mut paths = Vec::new();
    for folder in folders {
        for entry in std::fs::read_dir(folder).map_err(|error| Error::file(folder, error))? {
            let path = entry.map_err(|error| Error::file(folder, error))?.path();
            if path.extension().is_some_and(|ending| ending == ENDING) {
                paths.push(path);
            }
        }
    }
    paths.sort();
    Ok(paths)
}
