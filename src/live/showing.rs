//! Play within the record: stored moments are shown and nothing is computed, so that a slow run is shown fluently.
//!
//! The worlds stay where they are meanwhile. Where the film ends they are put at the end of the record, of which a
//! keyframe is kept; where it is stopped on the way, or something is asked of its moment, that is computed as for
//! the timeline.

use super::engine::Engine;
use super::{Command, Pace};

impl Engine {
    /// Time passes from the moment on that is shown.
    pub(super) fn restart_clock(&mut self) {
        self.clock.start(self.film.unwrap_or_else(|| self.worlds.time_secs()));
    }

    /// Shows what is stored, where that is asked for by play.
    pub(super) fn begin_film(&mut self) {
        let stored = self
            .worlds
            .tracks
            .iter()
            .all(|track| track.film.goes_on_from(track.simulation.observables().step));
        let is_slow = matches!(self.clock.pace, Pace::RealTime(_));
        if is_slow && stored && self.worlds.replay() {
            self.film = Some(self.worlds.time_secs());
        }
    }

    /// Goes on to the stored moment that is due.
    pub(super) fn advance_film(&mut self) {
        let due_secs = self.clock.time_secs();
        let end_secs = self.worlds.recorded_secs();
        let stop_secs = self.stop_at_secs.filter(|&stop| stop < end_secs);
        if due_secs < stop_secs.unwrap_or(end_secs) {
            self.film = Some(due_secs);
            self.clock.count(0, due_secs);
            self.unpublished = true;
            return;
        }
        // A run that has been at its end stops there.
        let half_step_secs = 0.5 * self.worlds.time_step_secs();
        self.playing &= self.stop_at_secs.is_none_or(|stop| end_secs + half_step_secs < stop);
        self.seek(stop_secs.unwrap_or(end_secs));
    }

    /// Computes the moment that is shown, which others are to go on from.
    pub(super) fn leave_film(&mut self) {
        if let Some(secs) = self.film {
            self.seek(secs);
        }
    }

    /// Starts on the way to a recorded moment.
    pub(super) fn seek(&mut self, secs: f64) {
        self.film = None;
        self.seeking = true;
        self.worlds.seek(secs);
    }
}

impl Command {
    /// Whether it is about the state at the moment that is shown.
    pub(super) fn is_about_the_moment(&self) -> bool {
        matches!(
            self,
            Self::Change(..)
                | Self::SetPull(..)
                | Self::Edit(..)
                | Self::Step
                | Self::Take(..)
                | Self::TakeAll(..)
        )
    }
}
