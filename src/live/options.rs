//! Options of the solver's thread of a live run (a simulation that the user watches while it is computed).

use std::time::Duration;

/// Options of the solver's thread.
pub struct LiveOptions {
    /// Callback on the solver's thread after each new frame (the data that the window draws), for example to make the
    /// window redraw.
    pub wake: Box<dyn Fn() + Send>,
    /// Callback during the loading of an initial state. If it returns true, the loading is cancelled. A thread that
    /// receives no commands during the loading can only be interrupted by this callback.
    pub gives_up: Box<dyn Fn() -> bool + Send>,
    /// Shortest wall-clock time between two frames (the data that the window draws) of a running simulation.
    pub frame_interval: Duration,
    /// Memory for keyframes (copies of the whole state) of all simulations together, bytes.
    pub recording_bytes: usize,
}

impl Default for LiveOptions {
    /// Returns options with callbacks that do nothing, 60 frames per second, and 96 MiB of keyframes (copies of
    /// states).
    fn default() -> Self {
        Self {
            wake: Box::new(|| {}),
            gives_up: Box::new(|| false),
            frame_interval: Duration::from_micros(16_600),
            recording_bytes: 96 << 20,
        }
    }
}
