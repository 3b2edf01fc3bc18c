//! For ParaView and all that reads VTK's files: `vtk/grains.pvd` and `vtk/contacts.pvd`, each a series of
//! one `.vtp` a frame. Grains are points with a radius, contacts lines from centre to centre, or to the
//! touched point of a boundary.
//!
//! Arrays have the names of the tables' columns. Two columns that are one vector are one array, `velocity`,
//! `normal` or `point`, with the columns' names for its components: VTK's vectors are in space. Words are
//! numbers, since nothing is coloured by words; `NAME_words`, an array of the file as a whole, has the
//! words in the order of the numbers, `columns` what each column is and its unit, `about` the run. What is
//! measured of the whole pile is there too, as `pile_NAME`.

#[cfg(feature = "data")]
mod decoding;
mod encoding;
mod poly_data;
mod series;

use std::path::{Path, PathBuf};

use super::files;
use super::format::{About, Format, Frame};
use crate::error::Result;
use crate::output::Draft;
#[cfg(feature = "data")]
pub(super) use decoding::{DataArray, Document, Piece, Said, values, words};
use series::Series;

/// Where the files are.
pub(super) const FOLDER: &str = "vtk";
/// The series of the grains.
pub(super) const GRAINS: &str = "grains.pvd";
/// Of the files, the beginnings of their names.
const KINDS: [&str; 2] = ["grains", "contacts"];
const ENDING: &str = ".vtp";
const SERIES: &str = ".pvd";

/// Writes series of files.
pub(super) struct Vtk {
    folder: PathBuf,
    about: About,
    /// Once there is a frame, or frames of before are gone on with; one of a kind.
    series: Option<[Series; 2]>,
}

impl Vtk {
    /// Starts, or goes on with what is there.
    ///
    /// # Errors
    /// Where the folder cannot be made.
    pub(super) fn start(folder: &Path, about: &About) -> Result<Self> {
        let folder = folder.join(FOLDER);
        files::make_folder(&folder)?;
        Ok(Self { folder, about: about.clone(), series: None })
    }

    /// Begins the series with the files of the first frames, each with its time, s.
    fn begin(&mut self, times: &[f64]) -> Result<&mut [Series; 2]> {
        let [grains, contacts] = KINDS.map(|kind| {
            let files =
                times.iter().zip(0..).map(|(&time, number)| (time, file_name(kind, number)));
            Series::of(self.folder.join(format!("{kind}{SERIES}")), &files.collect::<Vec<_>>())
        });
        Ok(self.series.insert([grains?, contacts?]))
    }
}

/// The files that are there.
///
/// # Errors
/// Where the folder cannot be read.
pub(super) fn files(folder: &Path) -> Result<Vec<PathBuf>> {
    let is_ours = |name: &str| {
        KINDS.iter().any(|kind| {
            name.strip_prefix(kind).is_some_and(|rest| rest == SERIES || number_of(rest).is_some())
        })
    };
    files::named(&folder.join(FOLDER), is_ours)
}

impl Format for Vtk {
    fn add(&mut self, frame: &Frame) -> Result<()> {
        if self.series.is_none() {
            self.begin(&[])?;
        }
        let texts = [encoding::grains(frame, &self.about), encoding::contacts(frame, &self.about)];
        let series = self.series.iter_mut().flatten();
        for ((kind, series), bytes) in KINDS.iter().zip(series).zip(texts) {
            let name = file_name(kind, frame.number);
            let mut draft = Draft::start(&self.folder.join(&name))?;
            draft.write(&bytes)?;
            // A run does not wait for the disk.
            draft.finish(false)?;
            series.add(frame.moment.observables.time_secs, &name)?;
        }
        Ok(())
    }

    fn flush(&mut self) -> Result<()> {
        Ok(())
    }

    fn roll_back(&mut self, _step: u64, last_frame: Option<u64>) -> Result<()> {
        self.series = None;
        let mut times = Vec::new();
        loop {
            let number = times.len() as u64;
            let [path, of_contacts] = KINDS.map(|kind| self.folder.join(file_name(kind, number)));
            if !path.exists() || !of_contacts.exists() {
                break;
            }
            let (step_of_file, time_secs) = encoding::moment_of(&path)?;
            if Some(step_of_file) > last_frame {
                break;
            }
            times.push(time_secs);
        }
        if !times.is_empty() {
            // What readers look at goes first.
            self.begin(&times)?;
        }
        let is_later = |name: &str| {
            let ours = KINDS.iter().find_map(|kind| name.strip_prefix(kind));
            let number = ours.and_then(number_of);
            number.map_or(ours == Some(SERIES) && times.is_empty(), |number| {
                number >= times.len() as u64
            })
        };
        let later = files::named(&self.folder, is_later)?;
        later.iter().try_for_each(|path| files::remove(path))
    }
}

fn file_name(kind: &str, number: u64) -> String {
    format!("{kind}_{number:06}{ENDING}")
}

/// The number of a file of ours, by what its name has behind its kind.
fn number_of(rest: &str) -> Option<u64> {
    let digits = rest.strip_prefix('_')?.strip_suffix(ENDING)?;
    let are_digits = digits.len() >= 6 && digits.bytes().all(|byte| byte.is_ascii_digit());
    are_digits.then(|| digits.parse().ok())?
}
