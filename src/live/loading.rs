//! Progress while an initial state is computed or read, for display.

use std::sync::Arc;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::sim::Snapshot;

/// Callback that receives the progress of a long computation, for example of an initial state. It returns false to
/// cancel the computation.
pub type Tell<'a> = &'a mut dyn FnMut(LoadingProgress) -> bool;

/// Progress of a long computation, for example of an initial state.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LoadingProgress {
    /// Completed fraction of the computation, 0 to 1.
    pub part: f32,
    /// Description of the progress in one line.
    pub text: String,
    /// Present state of the grains, if there is a state to show.
    pub preview: Option<Preview>,
}

/// A state of the grains while an initial state is still being computed. It is only drawn; it is not part of any
/// simulation.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Preview {
    /// The positions and velocities to show.
    pub snapshot: Arc<Snapshot>,
    /// Lower left and upper right corner of the view, m.
    pub view: [DVec2; 2],
}

impl PartialEq for Preview {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.snapshot, &other.snapshot)
    }
}
