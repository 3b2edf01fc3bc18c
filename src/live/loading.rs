//! Progress while an initial state is computed or read, for display.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::sim::Snapshot;

/// Callback that receives the progress of a long computation, for example of an initial state. It returns false to
/// cancel the computation.
pub type Tell<'a> = &'a mut dyn FnMut(LoadingProgress) -> bool;

/// Progress of a long computation, for example of an initial state.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct LoadingProgress {
    /// Completed fraction of the computation, 0 to 1.
    pub part: f32,
    /// Description of the progress in one line.
    pub text: String,
    /// Present state of the grains, if there is a state to show. It is only drawn; it is not part of any simulation.
    pub preview: Option<Arc<Snapshot>>,
}
