//! The clock of a live run (a simulation that the user watches while it is computed). It relates simulated time to
//! wall-clock time.

use std::sync::mpsc::{Receiver, RecvTimeoutError, TryRecvError};
use std::time::Duration;

use super::Pace;
use crate::Instant;

/// Largest delay that a run makes up for by taking steps faster than the chosen speed of playing. The delay is the
/// wall-clock time since the next step was due. A run with a larger delay does not catch up; it continues at the chosen
/// speed from its present state.
const MOST_LAG: Duration = Duration::from_millis(100);
/// Period of wall-clock time over which the displayed rates (such as steps per second) are averaged. With a shorter
/// period the displayed numbers fluctuate more; with a longer period they follow a change later.
const RATE_WINDOW: Duration = Duration::from_millis(300);

/// Receives a message, or returns a timeout error after the time `wait`. If `wait` is zero, no clock is read, because
/// the clock of Rust's standard library does not work in a browser.
pub(crate) fn receive_within<T>(
    inbox: &Receiver<T>,
    wait: Duration,
) -> std::result::Result<T, RecvTimeoutError> {
    if !wait.is_zero() {
        return inbox.recv_timeout(wait);
    }
    inbox.try_recv().map_err(|error| match error {
        TryRecvError::Empty => RecvTimeoutError::Timeout,
        TryRecvError::Disconnected => RecvTimeoutError::Disconnected,
    })
}

/// A clock that determines when the next step is due, and measures the rate of steps.
pub(super) struct Clock {
    pub pace: Pace,
    anchor: (Instant, f64),
    window: (Instant, f64, u64),
    steps: u64,
    /// Simulated time per wall-clock time (dimensionless), averaged over 300 ms.
    pub real_time_factor: f64,
    /// Steps of all simulations per second of wall-clock time, 1/s, averaged over 300 ms.
    pub steps_per_sec: f64,
}

impl Clock {
    pub(super) fn new() -> Self {
        let now = Instant::now();
        Self {
            pace: Pace::RealTime(1.0),
            anchor: (now, 0.0),
            window: (now, 0.0, 0),
            steps: 0,
            real_time_factor: 0.0,
            steps_per_sec: 0.0,
        }
    }

    /// Starts the clock of a run whose simulated time is now `time_secs`, s.
    pub(super) fn start(&mut self, time_secs: f64) {
        let now = Instant::now();
        self.anchor = (now, time_secs);
        self.window = (now, time_secs, self.steps);
    }

    /// Returns the simulated time that the run should have reached now, s.
    pub(super) fn time_secs(&self) -> f64 {
        let (anchor, anchor_secs) = self.anchor;
        let factor = if let Pace::RealTime(factor) = self.pace { factor } else { 0.0 };
        anchor_secs + factor * anchor.elapsed().as_secs_f64()
    }

    /// Returns the wall-clock time to wait before the step that begins at the simulated time `time_secs`, s, is due.
    pub(super) fn wait(&mut self, time_secs: f64) -> Duration {
        let Pace::RealTime(factor) = self.pace else { return Duration::ZERO };
        let (anchor, anchor_secs) = self.anchor;
        let due_secs = ((time_secs - anchor_secs) / factor.max(1e-6)).clamp(0.0, 1e6);
        let due = anchor + Duration::from_secs_f64(due_secs);
        let now = Instant::now();
        if now.saturating_duration_since(due) > MOST_LAG {
            self.anchor = (now, time_secs);
        }
        due.saturating_duration_since(now)
    }

    /// Records that `steps` more steps were taken, after which the simulated time is `time_secs`, s.
    pub(super) fn count(&mut self, steps: u64, time_secs: f64) {
        self.steps += steps;
        let (since, secs, steps) = self.window;
        let elapsed = since.elapsed();
        if elapsed >= RATE_WINDOW {
            self.real_time_factor = (time_secs - secs) / elapsed.as_secs_f64();
            self.steps_per_sec = (self.steps - steps) as f64 / elapsed.as_secs_f64();
            self.window = (Instant::now(), time_secs, self.steps);
        }
    }
}
