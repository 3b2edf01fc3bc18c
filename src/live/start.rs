//! What a live run begins with.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::record::Record;
use crate::sim::{Settings, Simulation, Tally};
use crate::world::Boundary;

/// The state that a run starts from.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Start {
    /// Name of the scene.
    pub name: String,
    /// The world at t = 0, or where a saved run goes on.
    pub simulation: Simulation,
    /// Sums over the steps before that.
    pub tally: Tally,
    /// The run pauses here once, s; played on, it goes further.
    pub duration_secs: f64,
    /// Shapes that are drawn before the first step: what holds a state that is at rest.
    pub held_by: Vec<Boundary>,
    /// Lower left and upper right corner of what pictures show, m.
    pub view: [DVec2; 2],
    /// Whether it is one of a heap on level ground, of which slump tells.
    pub slumps: bool,
    /// The settings of the worlds that are side by side at first; none for one world with those of the simulation.
    pub worlds: Vec<Settings>,
    /// What it has come to, where it does not begin here; then `worlds` means nothing.
    pub record: Option<Record>,
}
