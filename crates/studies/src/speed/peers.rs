//! Runs of other engines, from the tables that `benches/peers` writes.

use std::path::Path;

use serde::Deserialize;

use crate::error::{Error, Result};

/// One run of another engine.
#[derive(Clone, Debug, Deserialize)]
pub(super) struct PeerRun {
    /// Its name, version and precision.
    pub engine: String,
    /// Whether it collapses or rests between walls.
    pub scene: String,
    /// Time of a step, s.
    pub time_step_secs: f64,
    /// Substeps of a step.
    pub substeps: u32,
    /// Stiffness of its contacts, Hz.
    pub contact_hertz: f64,
    /// Overlap that it leaves alone, in diameters.
    pub slop: f64,
    /// Grains of the pile.
    pub grains: usize,
    /// Δy_G at the end.
    pub slump: f64,
    /// Mean overlap of touching grains, in diameters.
    pub mean_overlap: f64,
    /// Time that a step took, ms.
    pub ms_per_step: f64,
    /// The processor that it was measured on.
    pub processor: String,
    /// Time that a simulated second took, s.
    pub secs_per_simulated_sec: f64,
}

impl PeerRun {
    /// Whether it is a collapse of so many grains.
    pub(super) fn is_collapse_of(&self, grains: usize) -> bool {
        self.scene == "collapse" && self.grains == grains
    }

    /// Simulated seconds per second.
    pub(super) fn speed(&self) -> f64 {
        1.0 / self.secs_per_simulated_sec
    }
}

/// The runs of all tables in a folder; none where there is no folder.
///
/// # Errors
/// Where a table cannot be read.
pub(super) fn read(folder: &Path) -> Result<Vec<PeerRun>> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Ok(Vec::new()) };
    let mut paths: Vec<_> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "csv"));
    paths.sort();
    let mut runs = Vec::new();
    for path in paths {
        let refuse = |error: csv::Error| Error::file(&path, error);
        let mut reader =
            csv::ReaderBuilder::new().comment(Some(b'#')).from_path(&path).map_err(refuse)?;
        for run in reader.deserialize() {
            runs.push(run.map_err(refuse)?);
        }
    }
    Ok(runs)
}

/// The colour of engine number `index`, unlike that of any method.
pub(super) fn colour(index: usize) -> crate::chart::Rgb {
    [(120, 120, 120), (150, 90, 40), (90, 60, 140)][index % 3]
}
