//! A run that someone watches: simulations on a thread of their own.
//!
//! Commands go in by a channel ([`Command`]); the newest moment comes out by a triple buffer
//! ([`Frame`]). Neither side ever waits for the other. The thread records what it computes, so that
//! a run can be looked at again and continued from any moment (`recording`); several worlds that
//! start from one state are kept at the same simulated time.

mod clock;
mod command;
mod controls;
mod curve;
mod editing;
mod engine;
mod film;
mod frame;
mod handle;
mod loading;
mod options;
mod past;
mod progress;
mod publish;
mod record;
mod recording;
mod replay;
mod showing;
mod start;
mod taken;
mod track;
mod worlds;

pub use command::{Command, Loader, Pace, StartTaker, Taker};
pub use controls::{Change, Controls, HandMade};
pub use curve::Curve;
pub use frame::{Frame, StartInfo, WorldAlarm, WorldFrame};
pub use handle::Live;
pub use options::LiveOptions;
pub use past::{PastRun, PastWorld};
pub use progress::{Preview, Progress};
pub use record::{Plan, Record};
pub(crate) use recording::Recording;
pub use replay::Replay;
pub use start::Start;
pub use taken::Taken;
