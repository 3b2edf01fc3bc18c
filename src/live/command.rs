//! What can be asked of a live run, and what it begins with.

use std::sync::Arc;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::{RunHistory, WorldHistory, source_to_bytes};
use crate::config::Config;
use crate::error::Result;
use crate::scene::Scene;
use crate::sim::{Edit, Pull, Settings, Simulation, Snapshot, Tally};
use crate::world::{Boundary, Physics};

/// Hears how far a start has come. False where it is given up.
pub type Tell<'a> = &'a mut dyn FnMut(LoadingProgress) -> bool;

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

/// Takes down what a world has come to, with the start. It runs on the solver's thread, so it hands on what it gets and
/// does not work with it.
pub type Taker = Box<dyn FnOnce(Arc<LiveStart>, WorldHistory) + Send>;

/// Takes down the start with all that has come of it. It runs on the solver's thread, as a [`Taker`] does.
pub type StartTaker = Box<dyn FnOnce(LiveStart) + Send>;

/// Simulated time per time on the wall.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Pace {
    /// This many simulated seconds a second, or as many as the machine computes.
    RealTime(f64),
    /// As fast as the machine computes.
    Max,
}

/// What can be asked of a live run. World indices that do not exist are ignored.
#[derive(Serialize, Deserialize)]
pub enum Command {
    /// Replace everything by a new start, with one world.
    #[serde(skip)]
    Load(Box<dyn StartSource>),
    /// Give up the loading that is going on.
    CancelLoading,
    /// Run worlds with these settings side by side from the present start; one is the ordinary case. The
    /// present run is kept.
    Compare(Vec<Settings>),
    /// Change the settings of a world from its next step on.
    Change(usize, Settings),
    /// Tie a spring to a grain of a world, or take it away.
    SetPull(usize, Option<Pull>),
    /// Have a hand change a world from its next step on. What is recorded after this moment is kept as a run of its own.
    Edit(usize, Edit),
    /// Let time pass: what is recorded is shown, and more is computed at its end. With other settings than those
    /// that were recorded, the run branches off, and what is recorded is kept.
    Play,
    /// Stop time.
    Pause,
    /// Take one step (the world with the largest time step does; the others catch up), and pause.
    Step,
    /// Back to the start with the present settings; pauses. The run is kept ([`LiveFrame::past`](super::LiveFrame::past)).
    Reset,
    /// Back to the earlier run of that number, where it was left; pauses. The present one is kept.
    Return(u64),
    /// Call the earlier run of that number, or the present one where none is given, by a name.
    Name(Option<u64>, String),
    /// Go to the recorded moment nearest to this simulated time, s; pauses.
    Seek(f64),
    /// Hand out what a world has come to.
    #[serde(skip)]
    Take(usize, Taker),
    /// Hand out the start, with the history of all worlds and of the runs before.
    #[serde(skip)]
    TakeAll(StartTaker),
    /// Change the pace.
    SetPace(Pace),
    /// End the thread.
    Quit,
}

impl Command {
    /// True if it makes a start pointless that is being made.
    pub(super) fn interrupts(&self) -> bool {
        matches!(self, Self::CancelLoading | Self::Load(_) | Self::Quit)
    }

    /// True if it is about the state at the moment that is shown.
    pub(super) fn is_about_the_moment(&self) -> bool {
        matches!(
            self,
            Self::Change(..)
                | Self::SetPull(..)
                | Self::Edit(..)
                | Self::Step
                | Self::Take(..)
                | Self::TakeAll(..)
        )
    }

    /// True if it needs a state that a seek is still computing.
    pub(super) fn waits_for_seek(&self) -> bool {
        self.is_about_the_moment() || matches!(self, Self::Play | Self::Reset | Self::Return(..))
    }
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
        source_to_bytes(self)
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

/// How far a long preparation has come.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LoadingProgress {
    /// 0 … 1.
    pub part: f32,
    /// One line.
    pub text: String,
    /// How what is being made looks, where there is anything to see.
    pub preview: Option<Preview>,
}

/// What is being made, at one moment. It is shown, and no more: the worlds stay as they are.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Preview {
    /// The moment.
    pub snapshot: Arc<Snapshot>,
    /// Lower left and upper right corner of what there is to see, m.
    pub view: [DVec2; 2],
}

impl PartialEq for Preview {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.snapshot, &other.snapshot)
    }
}
