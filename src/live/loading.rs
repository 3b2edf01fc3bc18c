//! Progress of a start that is being made.

use std::sync::Arc;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::sim::Snapshot;

/// Receives the progress of a start. Returns false to give it up.
pub type Tell<'a> = &'a mut dyn FnMut(LoadingProgress) -> bool;

/// Progress of a long preparation.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LoadingProgress {
    /// Completed fraction, 0 … 1.
    pub part: f32,
    /// Description of the progress, one line.
    pub text: String,
    /// Present state of the preparation, if it can be shown.
    pub preview: Option<Preview>,
}

/// A moment of a preparation. It is only shown; the worlds do not change.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Preview {
    /// The moment.
    pub snapshot: Arc<Snapshot>,
    /// Lower left and upper right corner of the view, m.
    pub view: [DVec2; 2],
}

impl PartialEq for Preview {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.snapshot, &other.snapshot)
    }
}
