//! How a live run serves its window.

use std::time::Duration;

/// What the solver's thread is to do for its window.
pub struct LiveOptions {
    /// Called on the solver's thread after each new frame.
    pub wake: Box<dyn Fn() + Send>,
    /// Least time between two frames while the run goes on.
    pub frame_interval: Duration,
    /// Memory for keyframes, of all worlds together.
    pub recording_bytes: usize,
}

impl Default for LiveOptions {
    /// Nobody to wake, 60 frames a second, 256 MiB.
    fn default() -> Self {
        Self {
            wake: Box::new(|| {}),
            frame_interval: Duration::from_micros(16_600),
            recording_bytes: 256 << 20,
        }
    }
}
