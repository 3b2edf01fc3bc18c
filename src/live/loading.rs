//! Progress of a start that is being made.

use std::sync::Arc;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::sim::Snapshot;

/// Hears how far a start has come. False where it is given up.
pub type Tell<'a> = &'a mut dyn FnMut(LoadingProgress) -> bool;

/// How far a long preparation has come.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LoadingProgress {
    /// 0 … 1.
    pub part: f32,
    /// One line.
    pub text: String,
    /// How what is being made looks, where there is anything to see.
    pub preview: Option<Preview>,
}

/// What is being made, at one moment. It is shown, and no more: the worlds stay as they are.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Preview {
    /// The moment.
    pub snapshot: Arc<Snapshot>,
    /// Lower left and upper right corner of what there is to see, m.
    pub view: [DVec2; 2],
}

impl PartialEq for Preview {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.snapshot, &other.snapshot)
    }
}
