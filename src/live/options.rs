//! Options of a live run.

use std::time::Duration;

/// What the solver's thread is to do for its window.
pub struct LiveOptions {
    /// Called on the solver's thread after each new frame.
    pub wake: Box<dyn Fn() + Send>,
    /// Asked while a start is made: true where that is to be given up, though no command could come in meanwhile.
    pub gives_up: Box<dyn Fn() -> bool + Send>,
    /// Least time between two frames while the run goes on.
    pub frame_interval: Duration,
    /// Memory for keyframes, of all worlds together.
    pub recording_bytes: usize,
}

impl Default for LiveOptions {
    /// Nobody to wake, 60 frames a second, 96 MiB.
    fn default() -> Self {
        Self {
            wake: Box::new(|| {}),
            gives_up: Box::new(|| false),
            frame_interval: Duration::from_micros(16_600),
            recording_bytes: 96 << 20,
        }
    }
}
