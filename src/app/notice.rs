//! Sentences that the status bar shows for a while.

use std::time::Instant;

/// How long a notice stays, s.
const NOTICE_SECS: f32 = 8.0;

/// A sentence for the status bar.
#[derive(Clone, Debug)]
pub struct Notice {
    /// The sentence.
    pub text: String,
    /// Whether it tells of a failure.
    pub(crate) failure: bool,
    since: Instant,
}

impl Notice {
    /// One that begins now.
    pub(super) fn new(text: String, failure: bool) -> Self {
        Self { text, failure, since: Instant::now() }
    }

    /// For how long it stays yet, s.
    pub(super) fn left_secs(&self) -> Option<f32> {
        let left = NOTICE_SECS - self.since.elapsed().as_secs_f32();
        (left > 0.0).then_some(left)
    }
}
