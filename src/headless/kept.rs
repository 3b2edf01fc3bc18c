//! States that wait on disk for being drawn.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::DVec2;

use crate::error::{Error, Result};
use crate::render::{Style, automatic_range, force_reference};
use crate::sim::{ContactView, GrainView, Observables, Snapshot, Surroundings};

/// Numbers of a grain, and of a contact.
const GRAIN: usize = 11;
const CONTACT: usize = 9;

/// States of a run whose colours and widths follow the state: all frames need one scale, and that is
/// known at the end. They wait in a file that has no name, so that it is gone with the process.
pub(super) struct KeptStates {
    folder: PathBuf,
    file: File,
    states: Vec<Kept>,
    range: Option<(f64, f64)>,
    force_reference: f64,
}

/// What of a state stays in memory.
struct Kept {
    observables: Observables,
    surroundings: Arc<Surroundings>,
    grains: usize,
    contacts: usize,
    /// Where in the file the others are.
    offset: u64,
}

impl KeptStates {
    /// Starts with none. The file is in `folder`, or where the system has such files if none can be
    /// there.
    pub(super) fn start(folder: &Path) -> Result<Self> {
        let file = tempfile::tempfile_in(folder).or_else(|_| tempfile::tempfile());
        let file = file.map_err(|error| Error::file(folder, error))?;
        let states = Vec::new();
        Ok(Self { folder: folder.to_owned(), file, states, range: None, force_reference: 0.0 })
    }

    /// Number of states.
    pub(super) fn len(&self) -> usize {
        self.states.len()
    }

    /// Adds a state that is to be drawn in that style.
    pub(super) fn add(&mut self, style: &Style, snapshot: Snapshot) -> Result<()> {
        let (least, most) = automatic_range(style.colour_by, &snapshot);
        let all = self.range.map_or((least, most), |all| (all.0.min(least), all.1.max(most)));
        self.range = Some(all);
        self.force_reference = self.force_reference.max(force_reference(style, &snapshot));

        let Snapshot { observables, grains, contacts, surroundings } = snapshot;
        let numbers = grains.iter().flat_map(grain_numbers);
        let numbers = numbers.chain(contacts.iter().flat_map(contact_numbers));
        let bytes: Vec<u8> = numbers.flat_map(f64::to_le_bytes).collect();
        let offset = self.file.stream_position().map_err(|error| self.refuse(error))?;
        self.file.write_all(&bytes).map_err(|error| self.refuse(error))?;
        let (grains, contacts) = (grains.len(), contacts.len());
        self.states.push(Kept { observables, surroundings, grains, contacts, offset });
        Ok(())
    }

    /// Gives the style the scale that all states have in common.
    pub(super) fn set_scale(&self, style: &mut Style) {
        style.range = self.range;
        style.force_reference = Some(self.force_reference).filter(|&largest| largest > 0.0);
    }

    /// One of the states.
    pub(super) fn get(&mut self, number: usize) -> Result<Snapshot> {
        let Kept { observables, ref surroundings, grains, contacts, offset } = self.states[number];
        let surroundings = Arc::clone(surroundings);
        let mut bytes = vec![0; (grains * GRAIN + contacts * CONTACT) * size_of::<f64>()];
        let read = self.file.seek(SeekFrom::Start(offset));
        read.and_then(|_| self.file.read_exact(&mut bytes)).map_err(|error| self.refuse(error))?;
        let (numbers, _) = bytes.as_chunks();
        let numbers: Vec<f64> = numbers.iter().copied().map(f64::from_le_bytes).collect();
        let (of_grains, of_contacts) = numbers.split_at(grains * GRAIN);
        let grains = of_grains.as_chunks().0.iter().map(grain).collect();
        let contacts = of_contacts.as_chunks().0.iter().map(contact).collect();
        Ok(Snapshot { observables, grains, contacts, surroundings })
    }

    fn refuse(&self, error: std::io::Error) -> Error {
        Error::file(&self.folder, format!("states that wait for being drawn ({error})"))
    }
}

fn grain_numbers(grain: &GrainView) -> [f64; GRAIN] {
    let GrainView { position, radius, angle, velocity, angular_velocity, overlap, force, .. } =
        *grain;
    let (coordination, tone) = (f64::from(grain.coordination), f64::from(grain.tone));
    [
        position.x,
        position.y,
        radius,
        angle,
        velocity.x,
        velocity.y,
        angular_velocity,
        overlap,
        force,
        coordination,
        tone,
    ]
}

fn grain(numbers: &[f64; GRAIN]) -> GrainView {
    let [x, y, radius, angle, u, v, angular_velocity, overlap, force, coordination, tone] =
        *numbers;
    GrainView {
        position: DVec2::new(x, y),
        radius,
        angle,
        velocity: DVec2::new(u, v),
        angular_velocity,
        overlap,
        force,
        coordination: coordination as u32,
        tone: tone as u8,
    }
}

fn contact_numbers(contact: &ContactView) -> [f64; CONTACT] {
    let ContactView { from, to, normal_force, tangential_force, gap, .. } = *contact;
    let other = contact.other_grain.map_or(-1.0, f64::from);
    let grain = f64::from(contact.grain);
    [grain, other, from.x, from.y, to.x, to.y, normal_force, tangential_force, gap]
}

fn contact(numbers: &[f64; CONTACT]) -> ContactView {
    let [grain, other, from_x, from_y, to_x, to_y, normal_force, tangential_force, gap] = *numbers;
    ContactView {
        grain: grain as u32,
        other_grain: (other >= 0.0).then_some(other as u32),
        from: DVec2::new(from_x, from_y),
        to: DVec2::new(to_x, to_y),
        normal_force,
        tangential_force,
        gap,
    }
}
