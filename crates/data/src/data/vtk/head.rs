//! Writes and reads the first arrays of a VTK file: step and time of its frame, and the metadata of the run.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::vtk_file::VtkFile;
use crate::column_spec::STEP;
use crate::data::format::{Frame, RunFacts};
use crate::error::{Error, Result};

/// Name of the array with the simulated time, s. VTK's readers look for this name.
const TIME: &str = "TimeValue";
/// Number of bytes at the beginning of a file that contain its step and time.
const LONGEST_HEAD: u64 = 4096;

/// Returns the beginning of a file as text. It contains the file's step, its time and other single numbers.
pub(super) fn head_of(path: &Path) -> std::io::Result<String> {
    let mut head = Vec::new();
    File::open(path)?.take(LONGEST_HEAD).read_to_end(&mut head)?;
    Ok(String::from_utf8_lossy(&head).into_owned())
}

/// Returns the text of the number with the given name in the beginning of a file.
pub(super) fn number_in<'a>(head: &'a str, name: &str) -> Option<&'a str> {
    let (_, rest) = head.split_once(&format!("Name=\"{name}\""))?;
    Some(rest.split_once('>')?.1.split_once('<')?.0)
}

/// Reads step and simulated time (s) of the frame in a file.
pub(super) fn moment_of(path: &Path) -> Result<(u64, f64)> {
    let head = head_of(path).map_err(|error| Error::file(path, error))?;
    let step = number_in(&head, STEP).and_then(|number| number.parse().ok());
    let time_secs = number_in(&head, TIME).and_then(|number| number.parse().ok());
    step.zip(time_secs).ok_or_else(|| {
        Error::file(path, format!("says no {STEP} and {TIME}, but must be a file that slump wrote"))
    })
}

/// Adds step and simulated time (s) of a frame to a file.
pub(super) fn add_moment(file: &mut VtkFile, frame: &Frame) {
    let observables = &frame.moment.observables;
    file.add_number(STEP, observables.step as i64);
    file.add_number(TIME, observables.time_secs);
}

/// Adds the metadata of the run to a file.
pub(super) fn add_facts(file: &mut VtkFile, facts: &RunFacts) {
    let facts = facts.facts.iter().map(|(name, said)| format!("{name}: {said}"));
    file.add_words("about", facts);
}
