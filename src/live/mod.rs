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
mod mode;
mod record;
mod remote;
mod stored_moments;
mod world_history;

#[cfg(feature = "panels")]
pub(crate) use clock::receive_within;
#[cfg(feature = "panels")]
pub(crate) use command::as_json;
pub use command::{
    Command, LiveStart, LoadingProgress, Pace, Preview, StartSource, StartTaker, Taker, Tell,
};
pub use curve::Curve;
pub use frame::{LiveFrame, WorldAlarm, WorldFrame};
pub use handle::{Live, LiveOptions};
pub use history::{PastRun, PastWorld, RunHistory, WorldPlan};
pub use record::{Controls, ControlsChange, HandEdit, WorldRecord};
pub use remote::{Ask, Post, RemoteEngine, source_to_bytes};
pub use world_history::WorldHistory;
