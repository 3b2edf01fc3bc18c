//! Options of a live run.

use std::time::Duration;

/// Options of the solver's thread.
pub struct LiveOptions {
    /// Called on the solver's thread after each new frame.
    pub wake: Box<dyn Fn() + Send>,
    /// Called while a start is made: returns true to give it up, although no command can arrive meanwhile.
    pub gives_up: Box<dyn Fn() -> bool + Send>,
    /// Shortest time between two frames of a running simulation.
    pub frame_interval: Duration,
    /// Memory for keyframes of all worlds together, bytes.
    pub recording_bytes: usize,
}

impl Default for LiveOptions {
    /// No callback, 60 frames per second, 96 MiB.
    fn default() -> Self {
        Self {
            wake: Box::new(|| {}),
            gives_up: Box::new(|| false),
            frame_interval: Duration::from_micros(16_600),
            recording_bytes: 96 << 20,
        }
    }
}
