//! The initial state of a live run (a simulation that the user watches while it is computed), and the sources that
//! compute or read initial states.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::message::to_bytes;
use super::{RunHistory, Tell};
use crate::config::Config;
use crate::error::Result;
use crate::scene::Scene;
use crate::sim::{Settings, Simulation, Tally};
use crate::world::{Boundary, Physics};

/// A source of an initial state, for example a scene to build or a file to read. It is serialisable data, so that it
/// can be sent to the thread or process that computes the run.
pub trait StartSource: Send + 'static {
    /// Makes the initial state. `tell` receives the progress; if it returns false, `make` stops with an error.
    ///
    /// # Errors
    /// States why no initial state could be made.
    fn make(self: Box<Self>, tell: Tell<'_>) -> Result<LiveStart>;

    /// Encodes the source as bytes, from which a reader can recognise the type of the source.
    ///
    /// # Errors
    /// If the source cannot be encoded.
    fn to_bytes(&self) -> Result<Vec<u8>>;
}

/// Initial state of a live run (a simulation that the user watches while it is computed), with its scene, view and
/// history.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LiveStart {
    /// The scene in its initial state. The run pauses when it reaches the duration of the scene. If the user continues
    /// it, it pauses again after the same duration.
    pub scene: Scene,
    /// The configuration from which the scene can be built again.
    #[serde(with = "as_json")]
    pub config: Config,
    /// Arrangement of the window that saved this initial state, as text in the window's own form; `None` if no
    /// window saved it.
    pub window: Option<String>,
    /// The simulation at t = 0, or the state at which a saved run was left.
    pub simulation: Simulation,
    /// Sums over the steps before this state, such as the number of unsolved steps (a [`Tally`]).
    pub tally: Tally,
    /// Walls that support the grains only until the first step; they are drawn before the first step.
    pub held_by: Vec<Boundary>,
    /// Lower left and upper right corner of the view, m.
    pub view: [DVec2; 2],
    /// True if the scene is a heap on level ground, so that its slump (relative drop of the mean height) is
    /// meaningful.
    pub slumps: bool,
    /// Settings of the worlds (simulations) that start side by side; empty for one world with the settings of
    /// `simulation`.
    pub worlds: Vec<Settings>,
    /// History of a saved run that is to be continued. If a history is given, the settings in `worlds` have no effect.
    #[serde(rename = "record")]
    pub history: Option<RunHistory>,
}

impl LiveStart {
    /// The settings of the initial state.
    pub fn settings(&self) -> &Settings {
        self.simulation.settings()
    }

    /// The kind of equations (friction, rotation and so on) that the scene needs.
    pub fn physics(&self) -> Physics {
        self.simulation.physics()
    }
}

/// An initial state that already exists is its own source.
impl StartSource for LiveStart {
    fn make(self: Box<Self>, _: Tell<'_>) -> Result<LiveStart> {
        Ok(*self)
    }

    fn to_bytes(&self) -> Result<Vec<u8>> {
        to_bytes(self)
    }
}

/// Serialises a configuration as JSON text within any other format. A configuration finds its options by name, and
/// binary formats do not store names.
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
