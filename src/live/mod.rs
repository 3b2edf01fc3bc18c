//! A run that someone watches: simulations on a thread of their own.
//!
//! Commands go in by a channel ([`Command`]); the newest moment comes out by a triple buffer ([`LiveFrame`]). Neither side
//! ever waits for the other. The thread records what it computes in a [`RunHistory`], so that a run can be looked at
//! again and continued from any moment. Several worlds that start from one state are kept at the same simulated time.

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
pub use loading::{LoadingProgress, Preview, Tell};
pub use message::to_bytes;
pub use options::LiveOptions;
pub use record::{Controls, ControlsChange, HandEdit, WorldRecord};
pub use remote::{Ask, Post, RemoteEngine};
#[cfg(feature = "panels")]
pub(crate) use start::as_json;
pub use start::{LiveStart, StartSource};
pub use world_history::WorldHistory;
