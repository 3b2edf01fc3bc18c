//! The commands of a live run.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::{LiveStart, StartSource, WorldHistory};
use crate::sim::{Edit, Pull, Settings};

/// Receives a world's history with the start. It runs on the solver's thread, so it must only hand on what it gets.
pub type Taker = Box<dyn FnOnce(Arc<LiveStart>, WorldHistory) + Send>;

/// Receives the start with the whole history. It runs on the solver's thread, like a [`Taker`].
pub type StartTaker = Box<dyn FnOnce(LiveStart) + Send>;

/// Simulated time per wall-clock time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Pace {
    /// This many simulated seconds per second, or as many as the machine can compute.
    RealTime(f64),
    /// As fast as the machine computes.
    Max,
}

/// A command to a live run. World indices that do not exist are ignored.
#[derive(Serialize, Deserialize)]
pub enum Command {
    /// Replace everything by a new start, with one world.
    #[serde(skip)]
    Load(Box<dyn StartSource>),
    /// Give up the present loading.
    CancelLoading,
    /// Run worlds with these settings side by side from the present start; usually one. The present run is kept.
    Compare(Vec<Settings>),
    /// Change the settings of a world from its next step on.
    Change(usize, Settings),
    /// Tie a spring to a grain of a world, or remove it.
    SetPull(usize, Option<Pull>),
    /// Change a world by hand from its next step on. Recorded steps after this moment are kept as a run of their own.
    Edit(usize, Edit),
    /// Let time pass: show the recorded steps, and compute more at their end. With other settings than the recorded
    /// ones, the run branches off, and the recorded steps are kept.
    Play,
    /// Stop time.
    Pause,
    /// Take one step (the world with the largest time step does; the others catch up), and pause.
    Step,
    /// Go back to the start with the present settings, and pause. The run is kept
    /// ([`LiveFrame::past`](super::LiveFrame::past)).
    Reset,
    /// Go back to the earlier run of this number, or on to an undone one, at the moment at which it was left, and pause.
    /// The present run is kept.
    Return(u64),
    /// Name the earlier run of this number, or the present run if the number is `None`.
    Name(Option<u64>, String),
    /// Go to the recorded moment nearest to this simulated time, s, and pause.
    Seek(f64),
    /// Hand out the history of a world.
    #[serde(skip)]
    Take(usize, Taker),
    /// Hand out the start, with the history of all worlds and of the earlier runs.
    #[serde(skip)]
    TakeAll(StartTaker),
    /// Change the pace.
    SetPace(Pace),
    /// End the thread.
    Quit,
}

impl Command {
    /// True if the command makes the load that is under way pointless.
    pub(super) fn interrupts(&self) -> bool {
        matches!(self, Self::CancelLoading | Self::Load(_) | Self::Quit)
    }

    /// True if the command concerns the state at the moment shown.
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

    /// True if the command needs a state that a seek is still computing.
    pub(super) fn waits_for_seek(&self) -> bool {
        self.is_about_the_moment() || matches!(self, Self::Play | Self::Reset | Self::Return(..))
    }
}
