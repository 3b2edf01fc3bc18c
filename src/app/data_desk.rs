//! What is being done about data and saved runs.

use super::work::Work;

/// What the panel about data is busy with.
#[derive(Default)]
pub(crate) struct DataDesk {
    /// First and last simulated time of what is exported, s; all that is recorded where there are none.
    pub stretch: Option<[f64; 2]>,
    /// Whether an earlier recording in the folder is to be removed.
    pub overwrite: bool,
    /// The export that is going on.
    pub export: Option<Work>,
    /// What became of the last one, and whether it failed.
    pub told: Option<(String, bool)>,
    /// The file of a saved run, as it is typed.
    pub saved_run: String,
}
