//! The formats that there are.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::csv;
use super::format::{About, Format};
#[cfg(feature = "data")]
use super::parquet;
use super::{lammps, parts, vtk};
use crate::error::{Error, Result};

/// Files that a recording is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum FormatName {
    /// Parquet, for pandas, polars and their like
    Parquet,
    /// Text with commas
    Csv,
    /// Files of VTK, for ParaView
    Vtk,
    /// Dumps as LAMMPS writes them, for OVITO
    Ovito,
}

impl FormatName {
    /// All of them.
    pub const ALL: &[Self] = &[Self::Parquet, Self::Csv, Self::Vtk, Self::Ovito];

    /// What is written where nothing is said.
    pub const DEFAULT: Self = if cfg!(feature = "data") { Self::Parquet } else { Self::Csv };

    /// As options and scene files write it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Parquet => "parquet",
            Self::Csv => "csv",
            Self::Vtk => vtk::FOLDER,
            Self::Ovito => lammps::FOLDER,
        }
    }

    /// Whether this build can write it.
    ///
    /// # Errors
    /// Says what is missing.
    pub fn check(self) -> Result<()> {
        if cfg!(feature = "data") || self != Self::Parquet {
            return Ok(());
        }
        let names: Vec<_> =
            Self::ALL.iter().filter(|&&it| it != self).map(|it| it.name()).collect();
        let allowed = format!("{} in this build, which has not the feature data", names.join(", "));
        Err(Error::value("data-format", self.name(), allowed))
    }

    /// The files that it wrote into a folder. They are known whatever this build can write.
    pub(super) fn files(self, folder: &Path) -> Result<Vec<PathBuf>> {
        match self {
            Self::Parquet => parts::files(folder),
            Self::Csv => csv::files(folder),
            Self::Vtk => vtk::files(folder),
            Self::Ovito => lammps::files(folder),
        }
    }

    /// Starts, or goes on with what is there.
    pub(super) fn start(self, folder: &Path, about: &About) -> Result<Box<dyn Format>> {
        self.check()?;
        match self {
            #[cfg(feature = "data")]
            Self::Parquet => Ok(Box::new(parquet::Parquet::start(folder, about)?)),
            #[cfg(not(feature = "data"))]
            Self::Parquet => Err(Error::value("data-format", self.name(), "built in")),
            Self::Csv => Ok(Box::new(csv::Csv::start(folder, about)?)),
            Self::Vtk => Ok(Box::new(vtk::Vtk::start(folder, about)?)),
            Self::Ovito => Ok(Box::new(lammps::Lammps::start(folder, about)?)),
        }
    }
}
