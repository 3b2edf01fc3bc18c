//! What the buttons and keys of a run ask of it.

use super::state::AppState;
use crate::live::Command;

impl AppState {
    /// Releases, plays or pauses.
    pub(crate) fn toggle_play(&mut self) {
        let command = if self.frame.playing { Command::Pause } else { Command::Play };
        self.live.send(command);
    }

    /// Takes one step and pauses.
    pub fn step(&mut self) {
        self.live.send(Command::Step);
    }

    /// Goes one step back in the recording.
    pub(crate) fn step_back(&mut self) {
        let steps = self.frame.worlds.iter().map(|world| world.snapshot.observables.time_step_secs);
        let time_secs = self.frame.time_secs() - steps.fold(0.0, f64::max);
        self.live.send(Command::Seek(time_secs.max(0.0)));
    }

    /// Back to the start, with the present settings.
    pub(crate) fn reset(&mut self) {
        self.live.send(Command::Reset);
    }

    /// Back to the run that the present one has taken the place of last.
    pub(crate) fn undo(&mut self) {
        if let Some(last) = self.frame.past.last() {
            self.live.send(Command::Return(last.number));
        }
    }
}
