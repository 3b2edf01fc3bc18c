//! Snapshots of a run that are kept in a file until the end of the run and then drawn, because the common scale of
//! their colours is not known earlier.

use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::HeadlessOptions;
use super::folder::{Marks, WAITING};
use crate::error::{Error, Result};
use crate::output::{DraftFile, nameless_file};
use crate::render::{Style, automatic_range, force_reference};
use crate::sim::Snapshot;

/// Store of snapshots that are drawn at the end of a run. Colours of grains and widths of force lines need the same
/// scale in all pictures, and this scale is known only at the end of the run. The snapshots are in a temporary file
/// that disappears with the process, or in a named file if the run may be resumed.
pub(crate) struct WaitingStates {
    path: PathBuf,
    file: DraftFile,
    /// Offsets of all snapshots in the file, bytes, followed by the end of the last snapshot.
    places: Vec<u64>,
    range: Option<(f64, f64)>,
    force_reference: f64,
}

/// A snapshot with the number of the picture that will show it.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct WaitingState {
    number: usize,
    snapshot: Snapshot,
}

impl WaitingStates {
    /// Returns a store of snapshots to be drawn at the end of the run. Returns `None` if there are no pictures, or if
    /// they can be drawn during the run. They can if the style states the range of the colours and the force of the
    /// widest line, as far as the pictures need these scales. If `outlive` is true, the snapshots are in a named file,
    /// which remains when the process ends.
    ///
    /// # Errors
    /// Names the file and gives the system's message.
    pub(super) fn asked_for(
        options: &HeadlessOptions,
        style: &Style,
        marks: &Marks,
        outlive: bool,
    ) -> Result<Option<Self>> {
        let waits = style.colour_by.has_scale() && style.range.is_none()
            || style.show_forces && style.force_reference.is_none();
        if !waits {
            return Ok(None);
        }
        let beside = options.animation().and_then(Path::parent);
        match (&options.frames, beside) {
            (Some(folder), _) if outlive => {
                Self::go_on(&folder.join(WAITING), marks.waiting, style).map(Some)
            }
            (Some(folder), _) => Self::start(folder).map(Some),
            (None, Some(folder)) => Self::start(folder).map(Some),
            (None, None) => Ok(None),
        }
    }

    /// Returns an empty store of snapshots. Its temporary file is in `folder`, or in the system's temporary folder if
    /// no file can be created in `folder`.
    pub(crate) fn start(folder: &Path) -> Result<Self> {
        let file = nameless_file(folder).or_else(|_| nameless_file(&std::env::temp_dir()));
        Ok(Self::of(folder, file.map_err(|error| Error::file(folder, error))?))
    }

    /// Returns a store with the snapshots in the first `length` bytes of an existing file, which are to be drawn in the
    /// given style.
    pub(super) fn go_on(path: &Path, length: u64, style: &Style) -> Result<Self> {
        #[cfg(not(target_arch = "wasm32"))]
        let file =
            DraftFile::options().read(true).write(true).create(true).truncate(false).open(path);
        #[cfg(target_arch = "wasm32")]
        let file = nameless_file(path);
        let mut states = Self::of(path, file.map_err(|error| Error::file(path, error))?);
        while states.end() < length {
            let WaitingState { snapshot, .. } = states.read()?;
            states.measure(style, &snapshot);
            let end = states.file.stream_position().map_err(|error| states.refuse(error))?;
            states.places.push(end);
        }
        states.file.set_len(states.end()).map_err(|error| states.refuse(error))?;
        Ok(states)
    }

    fn of(path: &Path, file: DraftFile) -> Self {
        Self { path: path.to_owned(), file, places: vec![0], range: None, force_reference: 0.0 }
    }

    /// Number of snapshots in the file.
    pub(crate) fn len(&self) -> usize {
        self.places.len() - 1
    }

    /// Flushes all snapshots to the disk. Returns their total length in the file, bytes.
    pub(super) fn mark(&self) -> Result<u64> {
        self.file.sync_data().map_err(|error| self.refuse(error))?;
        Ok(self.end())
    }

    /// Adds a snapshot that is to be drawn in the given style as the picture with this number.
    pub(crate) fn add(&mut self, style: &Style, number: usize, snapshot: Snapshot) -> Result<()> {
        self.measure(style, &snapshot);
        let state = rmp_serde::to_vec_named(&WaitingState { number, snapshot });
        let state = state.map_err(|error| self.refuse(error))?;
        let bytes = [&(state.len() as u64).to_le_bytes()[..], &state].concat();
        self.file.write_all(&bytes).map_err(|error| self.refuse(error))?;
        self.places.push(self.end() + bytes.len() as u64);
        Ok(())
    }

    fn measure(&mut self, style: &Style, snapshot: &Snapshot) {
        let (least, most) = automatic_range(style.colour_by, snapshot);
        let all = self.range.map_or((least, most), |all| (all.0.min(least), all.1.max(most)));
        self.range = Some(all);
        self.force_reference = self.force_reference.max(force_reference(style, snapshot));
    }

    /// Sets the missing scales of the style (range of the colours, force of the widest line), so that they fit all
    /// snapshots.
    pub(crate) fn set_scale(&self, style: &mut Style) {
        let reference = Some(self.force_reference).filter(|&largest| largest > 0.0);
        style.range = style.range.or(self.range);
        style.force_reference = style.force_reference.or(reference);
    }

    /// Returns the snapshot at an index, with the number of its picture.
    pub(crate) fn get(&mut self, index: usize) -> Result<(usize, Snapshot)> {
        let place = SeekFrom::Start(self.places[index]);
        self.file.seek(place).map_err(|error| self.refuse(error))?;
        let WaitingState { number, snapshot } = self.read()?;
        Ok((number, snapshot))
    }

    fn end(&self) -> u64 {
        self.places.last().copied().unwrap_or(0)
    }

    /// Reads the snapshot at the current position of the file.
    fn read(&self) -> Result<WaitingState> {
        let (mut file, mut length, mut bytes) = (&self.file, [0; 8], Vec::new());
        let read = file.read_exact(&mut length);
        // Reads no more bytes than the file contains, even if a damaged file states a larger length.
        let read =
            read.and_then(|()| file.take(u64::from_le_bytes(length)).read_to_end(&mut bytes));
        read.map_err(|error| self.refuse(error))?;
        rmp_serde::from_slice(&bytes).map_err(|error| self.refuse(error))
    }

    fn refuse(&self, error: impl std::fmt::Display) -> Error {
        let said = format!("states that wait for being drawn must be kept there ({error})");
        Error::file(&self.path, said)
    }
}
