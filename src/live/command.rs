//! What can be asked of a live run, and what it begins with.

use std::sync::Arc;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::{RunHistory, WorldHistory};
use crate::error::Result;
use crate::sim::{Edit, Pull, Settings, Simulation, Snapshot, Tally};
use crate::world::{Boundary, Physics};

/// Makes a start. It runs on the solver's thread, tells of its progress, and gives up with an error
/// where the callback returns false.
pub type Loader =
    Box<dyn FnOnce(&mut dyn FnMut(LoadingProgress) -> bool) -> Result<LiveStart> + Send>;

/// Takes down what a world has come to. It runs on the solver's thread, so it hands on what it gets and
/// does not work with it.
pub type Taker = Box<dyn FnOnce(WorldHistory) + Send>;

/// Takes down the start with all that has come of it. It runs on the solver's thread, as a [`Taker`] does.
pub type StartTaker = Box<dyn FnOnce(LiveStart) + Send>;

/// Simulated time per time on the wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pace {
    /// This many simulated seconds a second, or as many as the machine computes.
    RealTime(f64),
    /// As fast as the machine computes.
    Max,
}

/// What can be asked of a live run. World indices that do not exist are ignored.
pub enum Command {
    /// Replace everything by a new start, with one world.
    Load(Loader),
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
    Take(usize, Taker),
    /// Hand out the start, with the history of all worlds and of the runs before.
    TakeAll(StartTaker),
    /// Change the pace.
    SetPace(Pace),
    /// End the thread.
    Quit,
}

impl Command {
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

/// How far a long preparation has come.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoadingProgress {
    /// 0 … 1.
    pub part: f32,
    /// One line.
    pub text: String,
    /// How what is being made looks, where there is anything to see.
    pub preview: Option<Preview>,
}

/// What is being made, at one moment. It is shown, and no more: the worlds stay as they are.
#[derive(Clone, Debug)]
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
