//! Lists the file formats of recordings that this build of the program can write, and creates their writers.

use std::path::Path;

use super::csv::Csv;
use super::format::{Format, RunFacts};
use super::lammps::Lammps;
#[cfg(feature = "data")]
use super::parquet::Parquet;
use super::vtk::{self, Vtk};
use crate::error::{Error, Result};
use crate::scene::{DataSettings, FormatName};

/// File format of a recording if the user does not ask for a format.
pub const DEFAULT_FORMAT: FormatName =
    if cfg!(feature = "data") { FormatName::Parquet } else { FormatName::Csv };

/// Returns the requested formats without repetitions, or the default format if no format is requested.
///
/// # Errors
/// If this build cannot write one of the requested formats.
pub fn formats_of(settings: &DataSettings) -> Result<Vec<FormatName>> {
    if settings.formats.is_empty() {
        return Ok(vec![DEFAULT_FORMAT]);
    }
    let formats = FormatName::ALL.iter().copied().filter(|it| settings.formats.contains(it));
    formats.map(|format| check_format(format).map(|()| format)).collect()
}

/// Fails if this build of the program cannot write a format.
///
/// # Errors
/// The error names the formats that this build can write, and the Cargo feature that is missing.
pub fn check_format(format: FormatName) -> Result<()> {
    if cfg!(feature = "data") || format != FormatName::Parquet {
        return Ok(());
    }
    let names: Vec<_> =
        FormatName::ALL.iter().filter(|&&it| it != format).map(|it| it.name()).collect();
    let allowed = format!("{} in this build, which has not the feature data", names.join(", "));
    Err(Error::value("data-format", format.name(), allowed))
}

pub(super) fn start_format(
    format: FormatName,
    folder: &Path,
    facts: &RunFacts,
) -> Result<Box<dyn Format>> {
    check_format(format)?;
    match format {
        #[cfg(feature = "data")]
        FormatName::Parquet => Ok(Box::new(Parquet::start(folder, facts)?)),
        #[cfg(not(feature = "data"))]
        FormatName::Parquet => Err(Error::value("data-format", format.name(), "built in")),
        FormatName::Csv => Ok(Box::new(Csv::start(folder, facts)?)),
        FormatName::Vtk => Ok(Box::new(Vtk::start(folder, &vtk::BODIES, facts)?)),
        FormatName::Fields => Ok(Box::new(Vtk::start(folder, &vtk::FIELDS, facts)?)),
        FormatName::Ovito => Ok(Box::new(Lammps::start(folder, facts)?)),
    }
}
