//! Defines how a study file describes the chart of a sweep: its x axis, curves and panels.

use serde::Deserialize;

use crate::error::{Error, Result};

/// Description of the chart of a sweep by the names of varied settings: one setting on the x axis, one for the curves,
/// and others for the panels.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SweepChart {
    /// Name of the setting on the x axis.
    pub x: String,
    /// Name of the setting that distinguishes the curves: the chart has one curve for each value of this setting.
    pub curves: String,
    /// Names of the settings that distinguish the panels: the chart has one panel for each combination of their values.
    #[serde(default)]
    pub panels: Vec<String>,
    /// Values of settings that select runs for comparison. The mean slump of these runs is drawn as a horizontal dashed
    /// line.
    #[serde(default)]
    pub level: toml::Table,
}

impl SweepChart {
    /// Checks that the study varies every setting that the chart names.
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
