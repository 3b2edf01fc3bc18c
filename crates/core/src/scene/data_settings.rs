//! What is asked of a recording.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::setting::words;

words! {
    /// Files that a recording is written as.
    pub enum FormatName {
        /// Apache Parquet.
        Parquet = "parquet", "Parquet, for pandas, polars and their like";
        /// Comma-separated values.
        Csv = "csv", "Text with commas";
        /// The Visualization Toolkit's.
        Vtk = "vtk", "Files of VTK, for ParaView";
        /// LAMMPS'.
        Ovito = "ovito", "Dumps as LAMMPS writes them, for OVITO";
    }
}

/// What scene files and studies say of a recording.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DataSettings {
    /// Where it goes; in a scene file, relative to that file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub folder: Option<PathBuf>,
    /// Simulated time between two frames, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub every_secs: Option<f64>,
    /// The files that are written; the reader's default where nothing is said.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub formats: Vec<FormatName>,
}

impl DataSettings {
    /// Checks the time between frames, under the name that it is said by.
    ///
    /// # Errors
    /// Where it is outside its range.
    pub fn validate(&self, field: &str) -> Result<()> {
        match self.every_secs {
            Some(secs) if !(secs > 0.0 && secs.is_finite()) => {
                Err(Error::value(field, secs, "a finite number of seconds > 0"))
            }
            _ => Ok(()),
        }
    }
}
