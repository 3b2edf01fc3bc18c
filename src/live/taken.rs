//! What a world has come to, for whoever takes it down.

use std::sync::Arc;

use super::Replay;
use crate::sim::{Simulation, Tally};

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
