//! The commands that a window sends to a live run (a simulation that the user watches while it is computed).

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::{LiveStart, StartSource, WorldHistory};
use crate::sim::{Edit, Pull, Settings};

/// Callback that receives the history of one simulation, with the initial state of the run. It runs on the solver's
/// thread, so it must only pass its arguments on and return quickly.
pub type Taker = Box<dyn FnOnce(Arc<LiveStart>, WorldHistory) + Send>;

/// Callback that receives the initial state of a run with its whole history. It runs on the solver's thread, so it
/// must return quickly.
pub type StartTaker = Box<dyn FnOnce(LiveStart) + Send>;

/// Speed of playing: simulated time per wall-clock time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Pace {
    /// This many simulated seconds per second of wall-clock time. If the machine is too slow for this pace, the run
    /// is as fast as the machine can compute.
    RealTime(f64),
    /// As fast as the machine computes.
    Max,
}

/// A command to a live run (a simulation that the user watches while it is computed). A *world* is one of the
/// simulations that run side by side. Commands with the index of a world that does not exist are ignored.
#[derive(Serialize, Deserialize)]
pub enum Command {
    /// Replace all simulations and their history by a new initial state from this source.
    #[serde(skip)]
    Load(Box<dyn StartSource>),
    /// Cancel the loading of an initial state.
    CancelLoading,
    /// Restart from the present initial state with one world (simulation) for each of these settings; the worlds run
    /// side by side. The previous run is kept.
    Compare(Vec<Settings>),
    /// Change the settings of the simulation with this index from its next step on.
    Change(usize, Settings),
    /// Tie a spring to a grain of the simulation with this index, so that the user can drag the grain; `None` removes
    /// the spring.
    SetPull(usize, Option<Pull>),
    /// Edit the simulation with this index (for example, move a grain) before its next step. If steps after the edit
    /// were already recorded, they are kept as a separate run.
    Edit(usize, Edit),
    /// Let simulated time advance: show the recorded steps, and compute more steps after the last recorded step. If the
    /// settings differ from the recorded settings, a new run begins, and the recorded steps are kept as a separate run.
    Play,
    /// Stop time.
    Pause,
    /// Take one step, and pause. The simulation with the largest time step takes one step; the other simulations take
    /// steps until they have reached the same time.
    Step,
    /// Go back to the initial state with the present settings, and pause. The previous run is kept in
    /// [`LiveFrame::past`](super::LiveFrame::past).
    Reset,
    /// Return to the run with this number, at the simulated time at which the user left that run, and pause. The run is
    /// an earlier run, or a run from which the user went back to an earlier run. The present run is kept.
    Return(u64),
    /// Go to the recorded state nearest to this simulated time, s, and pause.
    Seek(f64),
    /// Pass the history of the simulation with this index to the callback.
    #[serde(skip)]
    Take(usize, Taker),
    /// Pass the initial state to the callback, with the history of all simulations and of the earlier runs.
    #[serde(skip)]
    TakeAll(StartTaker),
    /// Change the speed of playing.
    SetPace(Pace),
    /// End the solver's thread.
    Quit,
}

impl Command {
    /// True if an initial state that is still being computed or read becomes useless by this command, for example
    /// because the command asks for another initial state.
    pub(super) fn interrupts(&self) -> bool {
        matches!(self, Self::CancelLoading | Self::Load(_) | Self::Quit)
    }

    /// True if the command uses the state of the run that the window shows: it changes settings or grains, takes a
    /// step, or reads the history. If the window shows a stored snapshot (a past state kept for display), the
    /// simulation must first reach that state.
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

    /// True if the command must wait until a seek has computed its state. (A seek is a jump to a recorded simulated
    /// time.)
    pub(super) fn waits_for_seek(&self) -> bool {
        self.is_about_the_moment() || matches!(self, Self::Play | Self::Reset | Self::Return(..))
    }
}
