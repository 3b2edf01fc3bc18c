//! What can be asked of a live run.

use std::sync::Arc;

use glam::DVec2;

use super::Replay;
use crate::error::Result;
use crate::sim::{Pull, Settings, Simulation, Tally};
use crate::world::Boundary;

/// The state that a run starts from.
#[derive(Clone, Debug)]
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
}

/// How far a long preparation has come.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Progress {
    /// 0 … 1.
    pub part: f32,
    /// One line.
    pub text: String,
}

/// Makes a start. It runs on the solver's thread, tells of its progress, and gives up with an error
/// where the callback returns false.
pub type Loader = Box<dyn FnOnce(&mut dyn FnMut(Progress) -> bool) -> Result<Start> + Send>;

/// All that a world has come to.
#[derive(Clone, Debug)]
pub struct Taken {
    /// The present moment, without the spring on a grain.
    pub simulation: Simulation,
    /// Sums over the steps up to it.
    pub tally: Tally,
    /// Why the run cannot go on from there.
    pub failure: Option<Arc<str>>,
    /// All that is recorded, before and after the present moment.
    pub replay: Replay,
}

/// Takes down what a world has come to. It runs on the solver's thread, so it hands on what it gets and
/// does not work with it.
pub type Taker = Box<dyn FnOnce(Taken) + Send>;

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
    /// Go to the recorded moment nearest to this simulated time, s; pauses.
    Seek(f64),
    /// Hand out what a world has come to.
    Take(usize, Taker),
    /// Change the pace.
    SetPace(Pace),
    /// End the thread.
    Quit,
}
