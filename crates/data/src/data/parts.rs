//! Names of the files of a table that is written in parts.

use std::path::{Path, PathBuf};

use super::columns::empty_tables;
use super::files;
use crate::error::Result;

/// Ending of a part's name.
const ENDING: &str = ".parquet";
const BEGINNING: &str = "part-";

/// The part of that number in a table's folder.
#[cfg(feature = "data")]
pub(super) fn path_of(folder: &Path, number: u64) -> PathBuf {
    folder.join(format!("{BEGINNING}{number:05}{ENDING}"))
}

fn number_of(name: &str) -> Option<u64> {
    let digits = name.strip_prefix(BEGINNING)?.strip_suffix(ENDING)?;
    digits.bytes().all(|byte| byte.is_ascii_digit()).then(|| digits.parse().ok())?
}

/// The parts in a table's folder with their numbers, by which they are sorted.
///
/// # Errors
/// Where the folder cannot be read.
pub(super) fn numbered(folder: &Path) -> Result<Vec<(u64, PathBuf)>> {
    let paths = files::named(folder, |name| number_of(name).is_some())?;
    let number = |path: &Path| path.file_name().and_then(|name| number_of(name.to_str()?));
    let numbered = paths.into_iter().filter_map(|path| Some((number(&path)?, path)));
    let mut numbered: Vec<_> = numbered.collect();
    // Beyond 99999 parts, names have more digits and sort otherwise.
    numbered.sort();
    Ok(numbered)
}

/// All parts of a recording, and what a kill left of such.
///
/// # Errors
/// Where a folder cannot be read.
pub(super) fn files(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    let (of_frames, steps) = empty_tables();
    for table in of_frames.iter().chain([&steps]) {
        files.extend(files::named(&folder.join(table.name), |name| number_of(name).is_some())?);
    }
    Ok(files)
}
