//! Where charts are made, and what is made there.

use std::path::PathBuf;

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::chart::Sheet;
use crate::error::Result;
use crate::journal::Journal;
use crate::machine::Machine;

/// A finished chart.
pub(super) struct Part {
    /// Name of its files.
    pub name: String,
    pub sheet: Sheet,
    /// Markdown; may be empty.
    pub report: String,
    /// (name, CSV) of tables beside the sheet's own.
    pub tables: Vec<(String, String)>,
}

/// Where charts are made.
pub(super) struct Bench {
    pub folder: PathBuf,
    pub quick: bool,
    pub large: bool,
    pub peers: PathBuf,
    pub machine: Machine,
}

impl Bench {
    pub(super) fn states_folder(&self) -> PathBuf {
        self.folder.join("states")
    }

    /// A journal for the measurements of this program on this machine, and what it holds.
    pub(super) fn journal<T: Serialize + DeserializeOwned>(
        &self,
        name: &str,
    ) -> Result<(Journal, Vec<T>)> {
        self.machine.journal(&self.folder, self.quick, name)
    }

    /// Lines below a chart: what it shows, then where it was measured.
    pub(super) fn caption(&self, lines: &[&str]) -> Vec<String> {
        let mut caption: Vec<String> = lines.iter().map(|&line| line.to_owned()).collect();
        let quick = if self.quick { "Quick pass. " } else { "" };
        caption.push(format!("{quick}{}", self.machine.words()));
        caption
    }
}
