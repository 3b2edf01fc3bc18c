//! What is chosen of recordings that the window writes.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::data::{DEFAULT_FORMAT, DataSettings, FormatName};

/// What outlives the window.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct DataChoices {
    /// The folder of the recording; below that of all files, unless it says otherwise.
    pub folder: PathBuf,
    /// Simulated time between two frames, s.
    pub every_secs: f64,
    /// A frame after each step, whatever `every_secs` says.
    pub each_step: bool,
    /// The files that are written.
    pub formats: Vec<FormatName>,
}

impl Default for DataChoices {
    fn default() -> Self {
        Self {
            folder: PathBuf::from("data"),
            every_secs: 0.01,
            each_step: false,
            formats: vec![DEFAULT_FORMAT],
        }
    }
}

impl DataChoices {
    /// As recordings are asked for.
    pub(crate) fn settings(&self) -> DataSettings {
        let every_secs = (!self.each_step).then_some(self.every_secs);
        DataSettings { folder: None, every_secs, formats: self.formats.clone() }
    }

    /// Whether files of a format are wanted.
    pub(crate) fn has(&self, format: FormatName) -> bool {
        self.formats.contains(&format)
    }

    /// Wants files of a format, or wants them no more.
    pub(crate) fn set(&mut self, format: FormatName, is_wanted: bool) {
        self.formats.retain(|other| *other != format);
        self.formats.extend(is_wanted.then_some(format));
    }
}
