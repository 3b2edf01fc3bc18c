//! The commands of a live run.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::{LiveStart, StartSource, WorldHistory};
use crate::sim::{Edit, Pull, Settings};

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
