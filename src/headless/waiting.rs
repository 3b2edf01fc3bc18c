//! States that wait on disk for being drawn.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use super::HeadlessOptions;
use crate::error::{Error, Result};
use crate::render::{Style, automatic_range, force_reference};
use crate::sim::Snapshot;

/// States of a run whose colours and widths follow the state: all frames need one scale, and that is
/// known at the end. They wait in a file that has no name, so that it is gone with the process.
pub(crate) struct WaitingStates {
    folder: PathBuf,
    file: File,
    /// Where in the file each state begins, and where the last one ends.
    places: Vec<u64>,
    range: Option<(f64, f64)>,
    force_reference: f64,
}

impl WaitingStates {
    /// Where states wait if the style asks for it.
    pub(super) fn asked_for(options: &HeadlessOptions, style: &Style) -> Result<Option<Self>> {
        let waits = style.colour_by.has_scale() && style.range.is_none()
            || style.show_forces && style.force_reference.is_none();
        let beside = options.animation().and_then(Path::parent);
        let folder = options.frames.as_deref().or(beside);
        folder.filter(|_| waits).map(Self::start).transpose()
    }

    /// Starts with none. The file is in `folder`, or where the system has such files if none can be
    /// there.
    pub(crate) fn start(folder: &Path) -> Result<Self> {
        let file = tempfile::tempfile_in(folder).or_else(|_| tempfile::tempfile());
        let file = file.map_err(|error| Error::file(folder, error))?;
        let folder = folder.to_owned();
        Ok(Self { folder, file, places: vec![0], range: None, force_reference: 0.0 })
    }

    pub(crate) fn len(&self) -> usize {
        self.places.len() - 1
    }

    /// Adds a state that is to be drawn in that style, with the number of its picture.
    pub(crate) fn add(&mut self, style: &Style, number: usize, snapshot: Snapshot) -> Result<()> {
        let (least, most) = automatic_range(style.colour_by, &snapshot);
        let all = self.range.map_or((least, most), |all| (all.0.min(least), all.1.max(most)));
        self.range = Some(all);
        self.force_reference = self.force_reference.max(force_reference(style, &snapshot));
        let state = rmp_serde::to_vec_named(&(number, snapshot));
        let state = state.map_err(|error| self.refuse(error))?;
        self.file.write_all(&state).map_err(|error| self.refuse(error))?;
        self.places.push(self.places[self.len()] + state.len() as u64);
        Ok(())
    }

    /// Gives the style the scale that all states have in common, but for what it has.
    pub(crate) fn set_scale(&self, style: &mut Style) {
        let reference = Some(self.force_reference).filter(|&largest| largest > 0.0);
        style.range = style.range.or(self.range);
        style.force_reference = style.force_reference.or(reference);
    }

    /// One of the states, by its place among them, with the number of its picture.
    pub(crate) fn get(&mut self, index: usize) -> Result<(usize, Snapshot)> {
        let [start, end] = [self.places[index], self.places[index + 1]];
        let mut state = vec![0; (end - start) as usize];
        let read = self.file.seek(SeekFrom::Start(start));
        let read = read.and_then(|_| self.file.read_exact(&mut state));
        read.map_err(|error| self.refuse(error))?;
        rmp_serde::from_slice(&state).map_err(|error| self.refuse(error))
    }

    fn refuse(&self, error: impl std::fmt::Display) -> Error {
        let said = format!("states that wait for being drawn must be kept there ({error})");
        Error::file(&self.folder, said)
    }
}
