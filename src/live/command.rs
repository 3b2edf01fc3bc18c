//! What can be asked of a live run.

use super::progress::Progress;
use super::start::Start;
use super::taken::Taken;
use crate::error::Result;
use crate::sim::{Edit, Pull, Settings};

/// Makes a start. It runs on the solver's thread, tells of its progress, and gives up with an error
/// where the callback returns false.
pub type Loader = Box<dyn FnOnce(&mut dyn FnMut(Progress) -> bool) -> Result<Start> + Send>;

/// Takes down what a world has come to. It runs on the solver's thread, so it hands on what it gets and
/// does not work with it.
pub type Taker = Box<dyn FnOnce(Taken) + Send>;

/// Takes down the start with all that has come of it. It runs on the solver's thread, as a [`Taker`] does.
pub type StartTaker = Box<dyn FnOnce(Start) + Send>;

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
    /// Back to the start with the present settings; pauses. The run is kept ([`Frame::past`](super::Frame::past)).
    Reset,
    /// Back to the earlier run of that number, where it was left; pauses. The present one is kept.
    Return(u64),
    /// Call the earlier run of that number, or the present one where none is given, by a name.
    Name(Option<u64>, String),
    /// Go to the recorded moment nearest to this simulated time, s; pauses.
    Seek(f64),
    /// Hand out what a world has come to.
    Take(usize, Taker),
    /// Hand out the start, with the record of all worlds and of the runs before.
    TakeAll(StartTaker),
    /// Change the pace.
    SetPace(Pace),
    /// End the thread.
    Quit,
}
