//! For OVITO and others that read what LAMMPS writes: `ovito/grains.dump`, a text dump with a row a grain,
//! and `ovito/contacts.dump`, a `dump local` with a row a contact between two discs, as bonds. A contact
//! with a boundary is left out: OVITO draws bonds between particles alone, and refuses the frame else.

mod dump;
mod frames;

use std::path::{Path, PathBuf};

use super::files;
use super::format::{About, Format, Frame};
use crate::error::Result;
use crate::output::GrowingFile;
use frames::DRAFT;
pub(super) use frames::read_frame;

/// Where the dumps are.
pub(super) const FOLDER: &str = "ovito";
/// The one with the grains.
pub(super) const GRAINS: &str = "grains.dump";
const CONTACTS: &str = "contacts.dump";

/// Writes dumps.
pub(super) struct Lammps {
    about: About,
    grains: Dump,
    contacts: Dump,
}

/// A dump that grows.
struct Dump {
    path: PathBuf,
    /// From the first frame on.
    file: Option<GrowingFile>,
}

impl Lammps {
    /// Starts, or goes on with what is there.
    ///
    /// # Errors
    /// Where the folder cannot be made.
    pub(super) fn start(folder: &Path, about: &About) -> Result<Self> {
        let folder = folder.join(FOLDER);
        files::make_folder(&folder)?;
        let dump = |name| Dump { path: folder.join(name), file: None };
        Ok(Self { about: about.clone(), grains: dump(GRAINS), contacts: dump(CONTACTS) })
    }
}

/// The files that are there.
///
/// # Errors
/// Where the folder cannot be read.
pub(super) fn files(folder: &Path) -> Result<Vec<PathBuf>> {
    files::named(&folder.join(FOLDER), |name| [GRAINS, CONTACTS].contains(&name))
}

impl Format for Lammps {
    fn add(&mut self, frame: &Frame) -> Result<()> {
        self.grains.add(&dump::grains(frame, &self.about))?;
        self.contacts.add(&dump::contacts(frame, &self.about))
    }

    fn flush(&mut self) -> Result<()> {
        Ok(())
    }

    fn finish(&mut self) -> Result<()> {
        let files = [&self.grains.file, &self.contacts.file];
        files.into_iter().flatten().for_each(GrowingFile::sync);
        Ok(())
    }

    fn roll_back(&mut self, _step: u64, last_frame: Option<u64>) -> Result<()> {
        self.grains.roll_back(last_frame)?;
        self.contacts.roll_back(last_frame)
    }
}

impl Dump {
    fn add(&mut self, text: &dump::Text) -> Result<()> {
        match &mut self.file {
            Some(file) => file.add_at_once(DRAFT, &text.head, &text.rows),
            none => {
                let file = none.insert(GrowingFile::start(self.path.clone())?);
                file.add_at_once(DRAFT, &(text.front.clone() + &text.head), &text.rows)
            }
        }
    }

    fn roll_back(&mut self, last_frame: Option<u64>) -> Result<()> {
        self.file = None;
        match frames::length_until(&self.path, last_frame)? {
            None => Ok(()),
            Some(0) => files::remove(&self.path),
            Some(length) => {
                self.file = Some(GrowingFile::go_on(self.path.clone(), length)?);
                Ok(())
            }
        }
    }
}
