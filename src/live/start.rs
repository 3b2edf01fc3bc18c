//! The state that a run starts from, and sources that make one.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::message::to_bytes;
use super::{RunHistory, Tell};
use crate::config::Config;
use crate::error::Result;
use crate::scene::Scene;
use crate::sim::{Settings, Simulation, Tally};
use crate::world::{Boundary, Physics};

/// What makes a start, as data, so that it can be sent to where the run is computed.
pub trait StartSource: Send + 'static {
    /// Makes it where the run is computed. Gives up with an error where `tell` returns false.
    ///
    /// # Errors
    /// Says why there is none.
    fn make(self: Box<Self>, tell: Tell<'_>) -> Result<LiveStart>;

    /// It as bytes, from which its kind reads it back.
    ///
    /// # Errors
    /// Where it cannot be sent.
    fn to_bytes(&self) -> Result<Vec<u8>>;
}

/// The state that a run starts from.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LiveStart {
    /// The scene, before anything moves. The run pauses once at its duration; played on, it goes further.
    pub scene: Scene,
    /// What opens that scene again.
    #[serde(with = "as_json")]
    pub config: Config,
    /// How the window was arranged that saved it, in that window's own words; none where none did.
    pub window: Option<String>,
    /// The world at t = 0, or where a saved run goes on.
    pub simulation: Simulation,
    /// Sums over the steps before that.
    pub tally: Tally,
    /// Shapes that are drawn before the first step: what holds a state that is at rest.
    pub held_by: Vec<Boundary>,
    /// Lower left and upper right corner of what pictures show, m.
    pub view: [DVec2; 2],
    /// True if it is one of a heap on level ground, of which slump tells.
    pub slumps: bool,
    /// The settings of the worlds that are side by side at first; none for one world with those of the simulation.
    pub worlds: Vec<Settings>,
    /// What it has come to, where it does not begin here; then `worlds` means nothing.
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

/// One that is ready.
impl StartSource for LiveStart {
    fn make(self: Box<Self>, _: Tell<'_>) -> Result<LiveStart> {
        Ok(*self)
    }

    fn to_bytes(&self) -> Result<Vec<u8>> {
        to_bytes(self)
    }
}

/// A config reads its options by name, which binary forms do not have.
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
