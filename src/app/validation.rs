//! What `slump validate` found, as its `quantities.json` tells it.

use std::path::Path;

use serde::Deserialize;

use crate::error::{Error, Result};
use crate::study::Verdict;

/// The command that makes a report in a few minutes.
pub(super) const COMMAND: &str = "slump validate --quick --out validation";
/// Where that leaves it.
const USUAL: &str = "validation/quantities.json";
/// What the full pass wrote, as it is shipped, …
const SHIPPED: &str = include_str!("../../assets/validation/quantities.json");
/// … and when and where.
const SHIPPED_FROM: &str =
    "shipped, by slump validate --time-steps 1e-3 on 2026-11-23, two shared cores";
/// What a report must be, for messages.
const FORM: &str = "the quantities.json that slump validate wrote";

/// A quantity of an experiment that was computed in one way.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub(super) struct Found {
    /// The experiment, as the command line calls it.
    pub experiment: String,
    /// Method, time step and effort.
    pub way: String,
    pub quantity: String,
    /// How large the systems were.
    pub system: String,
    pub published: Published,
    pub measured: Measured,
    pub verdict: Verdict,
}

/// What it should be.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub(super) struct Published {
    /// Ends of the band; none where it is open.
    pub low: Option<f64>,
    pub high: Option<f64>,
    pub provenance: String,
    pub source: String,
}

/// What it is, with the ends of its interval; none where there is no such number.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub(super) struct Measured {
    pub mean: Option<f64>,
    pub low: Option<f64>,
    pub high: Option<f64>,
}

/// A report, and where it comes from.
#[derive(Clone, Debug, Default)]
pub(super) struct Validation {
    /// The file, or when the shipped one was made.
    pub from: String,
    /// The quantities, experiment by experiment.
    pub found: Vec<Found>,
}

impl Validation {
    /// The report of the last run that was made here, or the one that is shipped.
    pub(super) fn of_last_run() -> Self {
        Self::read(USUAL.as_ref()).unwrap_or_else(|_| Self::shipped())
    }

    fn shipped() -> Self {
        let found = serde_json::from_str(SHIPPED).unwrap_or_default();
        Self { from: SHIPPED_FROM.to_owned(), found }
    }

    /// Reads a report, or that of a folder.
    ///
    /// # Errors
    /// Where the file cannot be read or is none.
    pub(super) fn read(path: &Path) -> Result<Self> {
        let path = if path.is_dir() { path.join("quantities.json") } else { path.to_owned() };
        let text = std::fs::read_to_string(&path);
        let text = text.map_err(|error| Error::unread(&path, error, FORM))?;
        let found = serde_json::from_str(&text);
        let found = found.map_err(|error| Error::unread(&path, error, FORM))?;
        Ok(Self { from: path.display().to_string(), found })
    }

    /// The experiments, each with its quantities, in the order of the report.
    pub(super) fn experiments(&self) -> impl Iterator<Item = &[Found]> {
        self.found.chunk_by(|one, other| one.experiment == other.experiment)
    }
}

/// The built-in scene that is most like that of an experiment, where there is one.
pub(super) fn scene_of(experiment: &str) -> Option<&'static str> {
    Some(match experiment {
        "collapse" | "cliff" => "collapse",
        "silo" | "janssen" => "silo",
        "repose" => "drum",
        "packing" => "pile",
        "shear" | "cohesive-shear" => "shear",
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::built_in;
    use crate::study::experiment_names;

    #[test]
    fn the_shipped_report_tells_of_every_experiment() {
        let report = Validation::shipped();
        let told: Vec<&str> =
            report.experiments().map(|found| found[0].experiment.as_str()).collect();
        let mut missing = experiment_names();
        missing.retain(|name| !told.contains(name));
        assert!(missing.is_empty(), "{missing:?} of {told:?}");
        assert!(report.found.iter().any(|found| found.measured.mean.is_some()));
    }

    #[test]
    fn the_scenes_of_experiments_are_built_in() {
        let scenes: Vec<&str> = experiment_names().into_iter().filter_map(scene_of).collect();
        assert!(scenes.len() >= 5, "{scenes:?}");
        for scene in scenes {
            assert!(built_in(scene).is_ok(), "{scene}");
        }
    }
}
