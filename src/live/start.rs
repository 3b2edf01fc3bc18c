//! The initial state of a run, and its sources.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::message::to_bytes;
use super::{RunHistory, Tell};
use crate::config::Config;
use crate::error::Result;
use crate::scene::Scene;
use crate::sim::{Settings, Simulation, Tally};
use crate::world::{Boundary, Physics};

/// A source of a start. It is data, so that it can be sent to the place of the computation.
pub trait StartSource: Send + 'static {
    /// Makes the start. Gives up with an error if `tell` returns false.
    ///
    /// # Errors
    /// Says why there is no start.
    fn make(self: Box<Self>, tell: Tell<'_>) -> Result<LiveStart>;

    /// The source as bytes, from which its type can be read.
    ///
    /// # Errors
    /// If it cannot be sent.
    fn to_bytes(&self) -> Result<Vec<u8>>;
}

/// The initial state of a run.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LiveStart {
    /// The scene in its initial state. The run pauses once at its duration, and can be continued.
    pub scene: Scene,
    /// The configuration that opens the scene again.
    #[serde(with = "as_json")]
    pub config: Config,
    /// Arrangement of the window that saved the start, in that window's own form; `None` without a window.
    pub window: Option<String>,
    /// The state at t = 0, or that of a saved run.
    pub simulation: Simulation,
    /// Sums over the steps before the start.
    pub tally: Tally,
    /// Shapes that hold a state at rest, drawn before the first step.
    pub held_by: Vec<Boundary>,
    /// Lower left and upper right corner of the view, m.
    pub view: [DVec2; 2],
    /// True if the scene is a heap on level ground, whose slump is meaningful.
    pub slumps: bool,
    /// Settings of the initial worlds side by side; empty for one world with the settings of the simulation.
    pub worlds: Vec<Settings>,
    /// History of a run that continues. `worlds` has no effect then.
    #[serde(rename = "record")]
    pub history: Option<RunHistory>,
}

impl LiveStart {
    /// The settings that the scene states.
    pub fn settings(&self) -> &Settings {
        self.simulation.settings()
    }

    /// The physics that the scene computes.
    pub fn physics(&self) -> Physics {
        self.simulation.physics()
    }
}

/// A start that is already made.
impl StartSource for LiveStart {
    fn make(self: Box<Self>, _: Tell<'_>) -> Result<LiveStart> {
        Ok(*self)
    }

    fn to_bytes(&self) -> Result<Vec<u8>> {
        to_bytes(self)
    }
}

/// Serialises a config as JSON, because it reads its options by name, which binary forms lack.
pub(crate) mod as_json {
    use serde::de::Error as _;
    use serde::ser::Error as _;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    use crate::config::Config;

    pub(crate) fn serialize<S: Serializer>(config: &Config, to: S) -> Result<S::Ok, S::Error> {
        serde_json::to_string(config).map_err(S::Error::custom)?.serialize(to)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>, C: From<Config>>(
        from: D,
    ) -> Result<C, D::Error> {
        let config: Config =
            serde_json::from_str(&String::deserialize(from)?).map_err(D::Error::custom)?;
        Ok(config.into())
    }
}
