//! What is asked of a recording.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::formats::FormatName;
use super::schedule::Times;
use crate::error::{Error, Result};

/// Simulated time between two frames where nothing is said, s: that of pictures.
const DEFAULT_EVERY_SECS: f64 = 0.04;

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
    /// The files that are written; Parquet where nothing is said.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub formats: Vec<FormatName>,
}

impl DataSettings {
    /// Checks what is said, under the name that it is said by.
    ///
    /// # Errors
    /// Names what is outside its range.
    pub fn validate(&self, field: &str) -> Result<()> {
        match self.every_secs {
            Some(secs) if !(secs > 0.0 && secs.is_finite()) => {
                Err(Error::value(field, secs, "a finite number of seconds > 0"))
            }
            _ => self.formats().into_iter().try_for_each(FormatName::check),
        }
    }

    /// The formats that are asked for, each once.
    pub fn formats(&self) -> Vec<FormatName> {
        if self.formats.is_empty() {
            return vec![FormatName::DEFAULT];
        }
        let asked = FormatName::ALL.iter().filter(|format| self.formats.contains(format));
        asked.copied().collect()
    }

    /// The times of the frames, where nothing but a rate is asked for.
    pub fn times(&self) -> Times {
        Times::Every(self.every_secs.unwrap_or(DEFAULT_EVERY_SECS))
    }
}
