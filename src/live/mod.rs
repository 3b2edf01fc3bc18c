//! Live runs: simulations that compute on a thread of their own while a user watches and changes them.
//!
//! The window sends commands through a channel ([`Command`]) and reads the newest data to draw from a triple buffer
//! ([`LiveFrame`]). The window never waits for the thread, and the thread never waits for the window. The thread
//! records all steps in a [`RunHistory`], so that the user can look at a run again and continue it from any recorded
//! time. Several simulations (*worlds*) that start from one initial state are kept at the same simulated time.

mod clock;
mod command;
mod curve;
mod engine;
mod frame;
mod handle;
mod history;
mod loading;
mod message;
mod mode;
mod options;
mod record;
mod remote;
mod start;
mod stored_moments;
mod world_history;

#[cfg(feature = "panels")]
pub(crate) use clock::receive_within;
pub use command::{Command, Pace, StartTaker, Taker};
pub use curve::Curve;
pub use frame::{LiveFrame, WorldAlarm, WorldFrame};
pub use handle::Live;
pub use history::{PastRun, PastWorld, RunHistory, WorldPlan};
pub use loading::{LoadingProgress, Tell};
pub use message::to_bytes;
pub use options::LiveOptions;
pub use record::{Controls, ControlsChange, HandEdit, WorldRecord};
pub use remote::{Ask, Post, RemoteEngine};
#[cfg(feature = "panels")]
pub(crate) use start::as_json;
pub use start::{LiveStart, StartSource};
pub use world_history::WorldHistory;
