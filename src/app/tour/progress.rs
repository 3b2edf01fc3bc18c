//! How far the tour has come, which outlives the window.

use serde::{Deserialize, Serialize};

/// How far someone has come on the tour.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Tour {
    /// The station, from 0.
    pub at: usize,
    /// Whether a window that is told nothing else opens there.
    pub on: bool,
    /// What was chosen before the tour, which comes back after it.
    pub(super) before: Option<Choices>,
}

impl Default for Tour {
    fn default() -> Self {
        Self { at: 0, on: true, before: None }
    }
}

/// What a station chooses in the place of the user.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Choices {
    pub quantities: Vec<String>,
    pub speed: f64,
    pub full_speed: bool,
}
