//! Defines the chart that a study file requests: its axis, curves and panels.

use serde::Deserialize;

use crate::error::{Error, Result};

/// The chart of a sweep, described by the names of varied settings.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SweepChart {
    /// Name of the setting on the x axis.
    pub x: String,
    /// Name of the setting that has one curve for each of its values.
    pub curves: String,
    /// Names of the settings that have one panel for each combination of their values.
    #[serde(default)]
    pub panels: Vec<String>,
    /// Values of settings. Runs with these values are drawn as horizontal lines, for comparison.
    #[serde(default)]
    pub level: toml::Table,
}

impl SweepChart {
    /// Checks that all settings of the chart are varied by the study.
    ///
    /// # Errors
    /// If the study does not vary a setting of the chart.
    pub(super) fn check(&self, varied: &[Vec<String>]) -> Result<()> {
        let names = || varied.iter().flatten();
        let one = [("chart.x", &self.x), ("chart.curves", &self.curves)].into_iter();
        let panels = self.panels.iter().map(|name| ("chart.panels", name));
        let levels = self.level.keys().map(|name| ("chart.level", name));
        for (field, name) in one.chain(panels).chain(levels) {
            if !names().any(|varied| varied == name) {
                let all: Vec<&str> = names().map(String::as_str).collect();
                let allowed = format!("a setting that varies: {}", all.join(", "));
                return Err(Error::value(field, name, allowed));
            }
        }
        Ok(())
    }
}
