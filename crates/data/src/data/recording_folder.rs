//! Manages the folder of a recording: the names of its files, the lock that reserves it for one recording, and the
//! manifest `data.json`, which describes the recording.

use std::path::{Path, PathBuf};

use serde_json::{Map, Value, json};

use super::columns::empty_tables;
use super::folder_files::{FRAMES, files_named, part_number, remove};
use super::format::RunFacts;
use super::table::{Column, Values};
use super::{csv, lammps, vtk};
use crate::error::{Error, Result};
use crate::output::{
    FolderLock, Locked, check_recognised, check_writable, final_name, is_recognised, write_file,
};
use crate::scene::FormatName;

/// Name of the file that lists the contents of a recording.
const MANIFEST: &str = "data.json";

/// A folder for a recording, locked so that no other recording can use it until this value is dropped.
pub struct RecordingFolder {
    path: PathBuf,
    overwrite: bool,
    _lock: FolderLock,
}

impl RecordingFolder {
    /// Creates the folder of a recording if it does not exist, and locks it.
    ///
    /// # Errors
    /// If the folder cannot be written to, if another process is recording into the folder, or if it contains a
    /// recording and `overwrite` is false.
    pub fn of(path: &Path, overwrite: bool) -> Result<Self> {
        let folder = Self::lock(path)?;
        let files = files_of_a_recording(path)?;
        if overwrite {
            files.iter().try_for_each(|file| check_recognised(file, "overwrite"))?;
        } else if let Some(first) = files.first() {
            let name = first.strip_prefix(path).unwrap_or(first).display();
            let allowed = format!(
                "a folder without an earlier recording ({name} is there), unless the option overwrite is given to \
                 remove it"
            );
            return Err(Error::value("data", path.display(), allowed));
        }
        Ok(Self { overwrite, ..folder })
    }

    /// Locks a folder to resume its recording, and removes the drafts (incomplete files) that a killed process left.
    ///
    /// # Errors
    /// If the folder cannot be written to, if another process is recording into it, or if a draft cannot be removed.
    pub fn to_go_on(path: &Path) -> Result<Self> {
        let folder = Self::lock(path)?;
        let mut left = files_of_a_recording(path)?;
        left.retain(|file| is_left(file));
        left.iter().try_for_each(|file| remove(file))?;
        Ok(folder)
    }

    fn lock(path: &Path) -> Result<Self> {
        check_writable("data", path)?;
        let lock = FolderLock::of(path, Locked::Recording)?;
        Ok(Self { path: path.to_owned(), overwrite: false, _lock: lock })
    }

    /// Returns the path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Removes an existing recording in the folder if `overwrite` is true.
    pub(super) fn clear(&self) -> Result<()> {
        if !self.overwrite {
            return Ok(());
        }
        files_of_a_recording(&self.path)?.iter().try_for_each(|file| remove(file))
    }
}

/// Removes the files of the recording in a folder, and then the folders of the recording that are empty. Files of other
/// programs remain.
///
/// # Errors
/// If another process is recording into the folder, or a file cannot be removed.
pub fn remove_recording(path: &Path) -> Result<()> {
    let folder = RecordingFolder::lock(path)?;
    for file in files_of_a_recording(path)? {
        if is_recognised(&file)? {
            remove(&file)?;
        }
    }
    let tables = empty_tables().map(|table| table.name);
    drop(folder);
    for inner in tables.chain([csv::FOLDER, vtk::BODIES.name, vtk::FIELDS.name, lammps::FOLDER, ""])
    {
        // A folder that is not empty remains.
        let _ = std::fs::remove_dir(path.join(inner));
    }
    Ok(())
}

/// Returns all files of a recording in a folder, of all formats. This includes formats that this build cannot write,
/// and drafts (incomplete files) that a killed process left.
fn files_of_a_recording(folder: &Path) -> Result<Vec<PathBuf>> {
    let tables: Vec<_> = empty_tables().map(|table| table.name).collect();
    let mut all = files_named(folder, |name| [MANIFEST, FRAMES].contains(&name))?;
    for table in &tables {
        all.extend(files_named(&folder.join(table), |name| part_number(name).is_some())?);
    }
    all.extend(files_named(&folder.join(csv::FOLDER), |name| {
        name.strip_suffix(".csv").is_some_and(|name| tables.contains(&name))
    })?);
    for files in [vtk::BODIES, vtk::FIELDS] {
        all.extend(files_named(&folder.join(files.name), |name| files.has_named(name))?);
    }
    all.extend(files_named(&folder.join(lammps::FOLDER), |name| lammps::FILES.contains(&name))?);
    Ok(all)
}

/// True if a file is a draft, an incomplete file that a killed process left.
fn is_left(path: &Path) -> bool {
    let name = path.file_name().and_then(|name| name.to_str());
    name.is_some_and(|name| final_name(name) != name)
}

pub(super) fn write_manifest(folder: &Path, formats: &[FormatName], run: &RunFacts) -> Result<()> {
    let path = folder.join(MANIFEST);
    let facts = run.facts.iter().map(|(name, said)| (name.clone(), Value::from(said.as_str())));
    let tables = empty_tables().map(|table| {
        let columns: Vec<Value> = table.columns.iter().map(column_in_manifest).collect();
        (table.name.to_owned(), Value::from(columns))
    });
    let manifest = json!({
        "program": "slump",
        "version": env!("CARGO_PKG_VERSION"),
        "formats": formats,
        "about": facts.collect::<Map<_, _>>(),
        "tables": Map::from_iter(tables),
    });
    let mut text =
        serde_json::to_string_pretty(&manifest).map_err(|error| Error::file(&path, error))?;
    text.push('\n');
    write_file(&path, text.as_bytes())
}

/// Fails if the recording in a folder has other formats than `formats`.
pub(super) fn check_manifest(folder: &Path, formats: &[FormatName]) -> Result<()> {
    let path = folder.join(MANIFEST);
    // If there is no manifest, there is no recording yet.
    let Ok(text) = std::fs::read(&path) else { return Ok(()) };
    let manifest: Value = serde_json::from_slice(&text)
        .map_err(|error| Error::unread(&path, error, "the manifest of a recording"))?;
    if manifest["formats"] == json!(formats) {
        return Ok(());
    }
    let names: Vec<_> = formats.iter().map(|format| format.name()).collect();
    let allowed = format!("as {} has it: {}", path.display(), manifest["formats"]);
    Err(Error::value("data-format", names.join(","), allowed))
}

/// Reads the metadata of a recording from its manifest: the values of its scene, by name. `path` is the folder of the
/// recording or a table in it. Returns `None` if there is no recording.
pub(crate) fn facts_of_recording(path: &Path) -> Option<Map<String, Value>> {
    let mut manifests = path.ancestors().take(3).map(|folder| folder.join(MANIFEST));
    let text = manifests.find_map(|path| std::fs::read(path).ok())?;
    let mut manifest: Value = serde_json::from_slice(&text).ok()?;
    manifest.get_mut("about").and_then(Value::as_object_mut).map(std::mem::take)
}

fn column_in_manifest(column: &Column) -> Value {
    let Column { name, unit, about, values } = column;
    let values = match values {
        Values::Numbers(_) | Values::SomeNumbers(_) => "number",
        Values::Counts(_) => "count",
        Values::Flags(_) => "flag",
        Values::Words { .. } => "word",
    };
    json!({ "name": name, "unit": unit, "about": about, "values": values })
}
