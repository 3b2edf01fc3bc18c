//! The formats that there are.

use std::path::{Path, PathBuf};

use super::csv;
use super::format::{About, Format};
#[cfg(feature = "data")]
use super::parquet;
use super::{lammps, parts, vtk};
use crate::error::{Error, Result};
use crate::scene::{DataSettings, FormatName};

/// What is written where nothing is said.
pub const DEFAULT_FORMAT: FormatName =
    if cfg!(feature = "data") { FormatName::Parquet } else { FormatName::Csv };

/// The formats that are asked for, each once.
///
/// # Errors
/// Where this build cannot write one of them.
pub fn formats_of(settings: &DataSettings) -> Result<Vec<FormatName>> {
    if settings.formats.is_empty() {
        return Ok(vec![DEFAULT_FORMAT]);
    }
    let asked = FormatName::ALL.iter().copied().filter(|it| settings.formats.contains(it));
    asked.map(|format| check_format(format).map(|()| format)).collect()
}

/// Whether this build can write it.
///
/// # Errors
/// Says what is missing.
pub fn check_format(format: FormatName) -> Result<()> {
    if cfg!(feature = "data") || format != FormatName::Parquet {
        return Ok(());
    }
    let names: Vec<_> =
        FormatName::ALL.iter().filter(|&&it| it != format).map(|it| it.name()).collect();
    let allowed = format!("{} in this build, which has not the feature data", names.join(", "));
    Err(Error::value("data-format", format.name(), allowed))
}

/// The files that it wrote into a folder. They are known whatever this build can write.
pub(super) fn files(format: FormatName, folder: &Path) -> Result<Vec<PathBuf>> {
    match format {
        FormatName::Parquet => parts::files(folder),
        FormatName::Csv => csv::files(folder),
        FormatName::Vtk => vtk::files(folder),
        FormatName::Ovito => lammps::files(folder),
    }
}

/// Starts, or goes on with what is there.
pub(super) fn start(format: FormatName, folder: &Path, about: &About) -> Result<Box<dyn Format>> {
    check_format(format)?;
    match format {
        #[cfg(feature = "data")]
        FormatName::Parquet => Ok(Box::new(parquet::Parquet::start(folder, about)?)),
        #[cfg(not(feature = "data"))]
        FormatName::Parquet => Err(Error::value("data-format", format.name(), "built in")),
        FormatName::Csv => Ok(Box::new(csv::Csv::start(folder, about)?)),
        FormatName::Vtk => Ok(Box::new(vtk::Vtk::start(folder, about)?)),
        FormatName::Ovito => Ok(Box::new(lammps::Lammps::start(folder, about)?)),
    }
}
