//! Defines the names of files in the folder of a recording, and finds and removes such files.

use std::io::ErrorKind::NotFound;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::output::final_name;

/// Name of the file that lists the frames of a recording that have been written completely, in all file formats of the
/// recording.
pub(super) const FRAMES: &str = "frames.csv";
/// Beginning of the name of a table's Parquet file. The number of the file follows.
const BEGINNING_OF_PART: &str = "part-";
/// Ending of the name of a table's Parquet file.
const ENDING_OF_PART: &str = ".parquet";

/// Returns the regular files in a folder whose names are accepted by `is_ours`, sorted. This includes drafts
/// (incomplete files) of such names that a killed process left. Links and pipes are left out. If the folder does not
/// exist, the list is empty.
pub(super) fn files_named(folder: &Path, is_ours: impl Fn(&str) -> bool) -> Result<Vec<PathBuf>> {
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
        if is_plain && entry.file_name().to_str().is_some_and(|name| is_ours(final_name(name))) {
            files.push(entry.path());
        }
    }
    files.sort();
    Ok(files)
}

pub(super) fn remove(path: &Path) -> Result<()> {
    std::fs::remove_file(path).map_err(|error| Error::file(path, error))
}

/// Creates a folder if it is missing.
pub(super) fn make_folder(path: &Path) -> Result<()> {
    std::fs::create_dir_all(path)
        .map_err(|error| Error::file(path, format!("cannot be written to ({error})")))
}

/// Returns the path of the Parquet file with the given number in the folder of a table.
#[cfg(feature = "data")]
pub(super) fn path_of_part(folder: &Path, number: u64) -> PathBuf {
    folder.join(format!("{BEGINNING_OF_PART}{number:05}{ENDING_OF_PART}"))
}

/// Returns the number in the name of a Parquet file of a table; `None` for any other name.
pub(super) fn part_number(name: &str) -> Option<u64> {
    let digits = name.strip_prefix(BEGINNING_OF_PART)?.strip_suffix(ENDING_OF_PART)?;
    digits.bytes().all(|byte| byte.is_ascii_digit()).then(|| digits.parse().ok())?
}

/// Returns the numbered Parquet files in the folder of a table, sorted by their numbers.
pub(super) fn numbered_parts(folder: &Path) -> Result<Vec<(u64, PathBuf)>> {
    let paths = files_named(folder, |name| part_number(name).is_some())?;
    let number = |path: &Path| path.file_name().and_then(|name| part_number(name.to_str()?));
    let numbered = paths.into_iter().filter_map(|path| Some((number(&path)?, path)));
    let mut numbered: Vec<_> = numbered.collect();
    // From file number 100,000 on, names have more digits and do not sort by number.
    numbered.sort();
    Ok(numbered)
}
